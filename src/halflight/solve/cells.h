// What the solver knows of each cell by itself: reflectance, exitance, light from outside.
#pragma once

#include <vector>

#include "halflight/solve/solver.h"

namespace halflight {

// Mean reflectance and exitance of a cell, textures sampled over its area.
void evaluate_material(SolverState& state, ElementId cell);

// Gives new children the light of their split parent and their own material.
void inherit(SolverState& state, const std::vector<ElementId>& split_cells);

// Evaluates punctual lights and sky on all leaf cells where they are not known yet, and splits cells
// on which they vary by more than the threshold (as in RefineOptions).
void update_outer_light(SolverState& state, float irradiance_threshold, std::uint64_t& rays);

}  // namespace halflight
