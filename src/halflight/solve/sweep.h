// One sweep: gather over the links, push irradiance down to the leaves, pull radiosity up.
#pragma once

#include <span>

#include "halflight/solve/solver.h"

namespace halflight {

struct Sweeps {
  int count = 0;
  bool converged = false;
};
inline constexpr int kMostSweeps = 60;
inline constexpr double kLittleChange = 2e-4;
// Sweeps (Jacobi) until not more than this share of all reflected power changes.
Sweeps sweep(SolverState& state, int most_sweeps = kMostSweeps,
             double largest_change = kLittleChange);

// After these receivers, and no others, have got new links: finds anew by what the light of links
// is multiplied at and below them. Their irradiance is left undefined.
void update_row_limits(SolverState& state, std::span<const ElementId> receivers);

// By which the next pull changes the radiosity of a leaf cell.
inline Rgb change_of_radiosity(const SolverState& state, ElementId leaf) {
  const Rgb reflected = state.reflectance[leaf] * state.irradiance[leaf];
  return state.exitance[leaf] + reflected - state.radiosity[leaf];
}

// Radiosity of every element from the irradiance of the leaves: B = rho E + pi L, means upwards.
void pull(SolverState& state);

}  // namespace halflight
