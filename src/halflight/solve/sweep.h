// One sweep: gather over the links, push irradiance down to the leaves, pull radiosity up.
#pragma once

#include "halflight/solve/solver.h"

namespace halflight {

struct Sweeps {
  int count = 0;
  bool converged = false;
};
// Sweeps (Jacobi) until radiosity changes by less than `tolerance` of its mean.
Sweeps sweep(SolverState& state, float tolerance, int most_sweeps);

// Radiosity of every element from the irradiance of the leaves: B = rho E + pi L, means upwards.
void pull(SolverState& state);

}  // namespace halflight
