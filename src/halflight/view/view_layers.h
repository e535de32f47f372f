// What the solver works with, as packets for the page to draw over the light.
#pragma once

#include <string>

#include "halflight/view/view_session.h"

namespace halflight {

// Outlines of the leaf cells, as lines; every nth of them where there are too many to show.
std::string elements_packet(const LiveSolution& live);

// Boxes of the clusters at a depth (or of leaves above it), with blocker size (BSIZE), extinction,
// and whether the multi-resolution criterion takes one right at a receiver as a medium.
std::string clusters_packet(const LiveSolution& live, int depth);

// Estimated relative error of irradiance at the vertices: once the picture is sharp, of the cells
// against a final gather; before, of the refined links by the oracle.
std::string error_packet(const LiveSolution& live);

// How many links have which error relative to what their receivers tolerate, in logarithmic bins.
std::string histogram(const LiveSolution& live);

// Where a picture from the view has shadow features wider than so many of its pixels.
std::string feature_mask_packet(const LiveSolution& live, const ViewOfInterest& view, float pixels);

}  // namespace halflight
