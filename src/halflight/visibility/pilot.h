// Whether clusters taken as media can save work in a scene: a short trial before a tree is built.
#pragma once

#include "halflight/hierarchy/bodies.h"
#include "halflight/rays/world.h"

namespace halflight {

// What decides. Rays through porous clutter (leaves, gratings) are noisy one by one, and there an
// average saves rays; through closed boxes it saves next to nothing (docs/design/visibility.md).
struct ClutterMeasure {
  std::size_t small_sheets = 0;  // triangles smaller than the feature size, not of closed bodies
  float optical_depth = 0.f;     // of these, were they spread evenly over the scene's bounds
};
ClutterMeasure measure_clutter(const World& world, const Bodies& bodies, float feature_size);

// Deterministic, so that the same scene always gives the same bytes: time is not asked.
bool clusters_pay(const ClutterMeasure& clutter);

}  // namespace halflight
