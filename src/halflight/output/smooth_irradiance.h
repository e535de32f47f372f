// Irradiance of the solution as a function that is linear over each leaf cell, not constant.
#pragma once

#include "halflight/solve/solver.h"

namespace halflight {

// Every cell takes its slopes from the splits that made it: along each axis of its surface, the
// difference of the last two halves over their distance, limited (minmod) by the same at the split
// before, so that noise and shadow edges make no overshoot. Means of cells stay as they are. Refers
// to the tree.
class SmoothIrradiance {
 public:
  explicit SmoothIrradiance(const SolverState& state)
      : SmoothIrradiance(state.tree, state.irradiance) {}
  SmoothIrradiance(const ElementTree& tree, IdVector<ElementId, Rgb> of_leaves);

  // At a point of the surface inside the leaf cell; not negative.
  Rgb at(ElementId leaf, const Vec3& position) const;

 private:
  struct Slopes {
    Rgb u{0.f}, v{0.f};  // change of irradiance per metre along the surface's axes
  };
  const ElementTree* tree_;
  IdVector<ElementId, Rgb> of_leaves_;
  IdVector<ElementId, Slopes> slopes_;
};

}  // namespace halflight
