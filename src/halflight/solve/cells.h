// What the solver knows of each cell by itself: reflectance, exitance, light from outside.
#pragma once

#include <vector>

#include "halflight/solve/solver.h"
#include "halflight/transport/emitter_tree.h"

namespace halflight {

// Mean reflectance and exitance of a cell, textures sampled over its area.
void evaluate_material(SolverState& state, ElementId cell);

// Gives new children the light of their split parent and their own material.
void inherit(SolverState& state, const std::vector<ElementId>& split_cells);

// Evaluates the light that links do not carry on all leaf cells where it is not known yet, and
// splits cells on which it varies by more than the threshold (as in RefineOptions). `emitters` adds
// emitting surfaces to punctual lights and sky; null leaves them to the links.
void update_given_light(SolverState& state, float irradiance_threshold,
                        const EmitterTree* emitters);

}  // namespace halflight
