// Fewer sweeps: what a sweep has found is mixed with what the last ones found, so that the change
// it asks for becomes least (Anderson acceleration: Anderson 1965; Walker & Ni 2011). Plain sweeps
// hand light to and fro between white surfaces face to face, and fill bright pockets slowly.
#pragma once

#include <array>

#include "halflight/solve/solver.h"

namespace halflight {

// For consecutive sweeps over the same links.
class AndersonMixing {
 public:
  // After gather and push, before pull: moves the irradiance of leaf cells.
  void mix(SolverState& state);

 private:
  struct Past {
    IdVector<ElementId, Rgb> irradiance;  // of leaf cells, as the sweep found it, W/m2
    IdVector<ElementId, Rgb> change;      // of their radiosity by it, W/m2
  };
  std::array<Past, 2> past_{};  // the last sweep, the one before
  int known_ = 0;
};

}  // namespace halflight
