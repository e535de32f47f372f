#include "halflight/visibility/pilot.h"

#include <algorithm>

namespace halflight {
namespace {

// Below this many Embree is as fast, and the tree is not worth its building.
constexpr std::size_t kLeastSheets = 100'000;
constexpr float kLeastDepth = 0.3f;
constexpr float kLargestLeaf = 3e-3f;  // of the scene's diagonal, however large the feature size

}  // namespace

ClutterMeasure measure_clutter(const World& world, const Bodies& bodies, float feature_size) {
  const Geometry& g = world.geometry;
  ClutterMeasure measure;
  if (g.triangles.size() < kLeastSheets) return measure;
  const float largest = std::min(feature_size, kLargestLeaf * g.bounds.diagonal());
  double sheets = 0.0;
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    const double area = static_cast<double>(g.area(t));
    const auto [a, b, c] = g.corners(t);
    const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (bodies.closed[bodies.of_triangle[t]] || longest > largest) continue;
    sheets += area;
    ++measure.small_sheets;
  }
  // A / 2V (extinction.h) over the longest way through the scene.
  const Vec3 e = g.bounds.extent();
  const double volume = std::max(1e-30, static_cast<double>(e.x * e.y * e.z));
  measure.optical_depth =
      static_cast<float>(sheets / (2.0 * volume) * static_cast<double>(g.bounds.longest_side()));
  return measure;
}

bool clusters_pay(const ClutterMeasure& clutter) {
  return clutter.small_sheets >= kLeastSheets && clutter.optical_depth >= kLeastDepth;
}

}  // namespace halflight
