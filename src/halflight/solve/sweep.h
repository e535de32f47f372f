// One sweep: gather over the links, push irradiance down to the leaves, pull radiosity up.
#pragma once

#include "halflight/solve/solver.h"

namespace halflight {

struct Sweeps {
  int count = 0;
  bool converged = false;
};
inline constexpr int kMostSweeps = 60;
// Sweeps (Jacobi) until radiosity hardly changes any more.
Sweeps sweep(SolverState& state, int most_sweeps = kMostSweeps);

// Radiosity of every element from the irradiance of the leaves: B = rho E + pi L, means upwards.
void pull(SolverState& state);

}  // namespace halflight
