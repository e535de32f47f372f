// Importance: how much a picture changes with the light at a place, directly and by reflection. It
// travels against the light along the same links (Smits, Arvo & Salesin 1992).
#pragma once

#include <vector>

#include "halflight/solve/feature_sizes.h"
#include "halflight/solve/solver.h"

namespace halflight {

// What rays through the pixels of a view meet, some pixels apart.
std::vector<RayHit> seen_surfaces(const World& world, const ViewOfInterest& view);

// Importance of errors of irradiance, in [kLeastImportance, 1]: 1 for what is seen, less for what
// only lights it.
IdVector<ElementId, float> solve_importance(const SolverState& state,
                                            const std::vector<RayHit>& seen);

inline constexpr float kLeastImportance = 1e-3f;
// Below this it makes no difference how well the light is known.
inline constexpr float kNegligibleImportance = 0.02f;

}  // namespace halflight
