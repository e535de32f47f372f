// Light groups: solving for all of them at once, taking their light apart, and mixing it anew.
#pragma once

#include <span>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/solve/solver.h"

namespace halflight {

inline constexpr float kLargestFactor = 1e6f;  // by which a group is made brighter

// Makes the state one of several groups, before its first iteration.
void set_groups(SolverState& state, std::vector<LightGroup> groups);

// After the first iteration: goes on with all groups equally bright on average and the threshold
// lowered by the square root of their number. Errors then count relative to each group's own light:
// what is dim beside the others has its shadows refined as well.
void balance(SolverState& state, const Progress& progress);

// Finds the light of each group over the cells and links that there are, and ends with all groups
// as the scene says.
void separate(SolverState& state, const Progress& progress);

// Light of a separated state with each group multiplied by a factor: irradiance, exitance and
// radiosity, in place. The world stays as it was.
void mix(SolverState& state, std::span<const Rgb> factors);

// The same for a state that is not separated, by finding the light of all groups together anew over
// the cells and links that there are; the world follows. Cells and links keep the shape that the
// light so far has given them.
void shine(SolverState& state, std::span<const Rgb> factors);

// Puts the state into a world that shines by these factors: what reads direct light afresh, as
// readers of the solution do, needs this beside `mix`.
void relight(SolverState& state, std::span<const Rgb> factors);

}  // namespace halflight
