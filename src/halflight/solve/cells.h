// What the solver knows of each cell by itself: reflectance, exitance, light from outside.
#pragma once

#include <vector>

#include "halflight/solve/solver.h"
#include "halflight/transport/emitter_tree.h"
#include "halflight/transport/sampled_links.h"

namespace halflight {

// Metres: of all cells, whatever the feature size.
float finest_cell(const SolverState& state);
// A cell is not split below this size, metres: half its feature size.
float smallest_cell(const SolverState& state, ElementId cell);

// Mean reflectance and exitance of a cell, textures sampled over its area.
void evaluate_material(SolverState& state, ElementId cell);

// Gives new children the light of their split parent and their own material.
void inherit(SolverState& state, const std::vector<ElementId>& split_cells);

// The cut below some elements that receives sampled links in this round.
std::vector<ElementId> receivers_of(const SolverState& state, std::vector<ElementId> below);
// Before a round: sets the size of clusters that receive as one to the least, in feature sizes,
// with which about so many elements receive, and at least 1.
void limit_receivers(SolverState& state, std::size_t most);

// How receivers look around in this round.
// `received`: by all cells so far, W; bright receivers then take more rays.
SampledLinkOptions sampled_link_options(const SolverState& state, double received = 0.0);

// Evaluates the light that sampled links do not carry on the cells of receiving clusters, by one
// directional irradiance for each cluster.
void give_light_to_clusters(SolverState& state, const std::vector<ElementId>& receivers,
                            const SampledLinkOptions& options_of_all);

// Power that all leaf cells receive, W.
double received_power(const SolverState& state);

// Evaluates the light that links do not carry on all leaf cells where it is not known yet, and
// splits cells on which it varies by more than the threshold (as in RefineOptions).
void update_given_light(SolverState& state, float irradiance_threshold);
// The same on the leaf cells below these receivers, with the power received by all.
void update_given_light(SolverState& state, float irradiance_threshold,
                        const std::vector<ElementId>& receivers, double total_power);

}  // namespace halflight
