// Irradiance of the solution as a function that is linear over each leaf cell, not constant, and
// free of what is only noise of the samples.
#pragma once

#include "halflight/solve/solver.h"

namespace halflight {

// Walks down from whole sides. Along each axis of its surface a cell has a slope, of the splits
// that made it: the difference of the last two halves over their distance, limited (minmod) by that
// of the split before, so that shadow edges make no overshoot. What the slope of a cell does not
// explain of the difference of its halves is kept in so far as it stands out of its own variance
// (Wiener's filter on the hierarchy); means of whole sides stay as they are. Refers to the tree.
class SmoothIrradiance {
 public:
  explicit SmoothIrradiance(const SolverState& state)
      : SmoothIrradiance(state.tree, state.irradiance) {}
  // variance: of the average channel of each leaf; empty: none.
  SmoothIrradiance(const ElementTree& tree, IdVector<ElementId, Rgb> of_leaves,
                   IdVector<ElementId, float> variance = {});

  // At a point of the surface inside the leaf cell; not negative.
  Rgb at(ElementId leaf, const Vec3& position) const;

 private:
  struct Slopes {
    Rgb u{0.f}, v{0.f};  // change of irradiance per metre along the surface's axes
  };
  void split(ElementId cell, const IdVector<ElementId, Rgb>& means,
             const IdVector<ElementId, float>& variances);

  const ElementTree* tree_;
  IdVector<ElementId, Rgb> of_cells_;
  IdVector<ElementId, Slopes> slopes_;
};

}  // namespace halflight
