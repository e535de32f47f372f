#include "halflight/visibility/emitter_widths.h"

namespace halflight {

IdVector<TriangleId, float> emitter_widths(const World& world, const Bodies& bodies) {
  const Geometry& g = world.geometry;
  const auto emits = [&](TriangleId t) { return world.scene.materials[g.materials[t]].emits(); };
  IdVector<BodyId, Bounds3f> boxes(bodies.size());
  for (std::size_t i = 0; i < g.triangles.size(); ++i)
    if (emits(TriangleId(i)))
      for (const Vec3& p : g.corners(TriangleId(i)))
        boxes[bodies.of_triangle[TriangleId(i)]].extend(p);
  IdVector<TriangleId, float> widths(g.triangles.size(), 0.f);
  for (std::size_t i = 0; i < widths.size(); ++i)
    if (emits(TriangleId(i)))
      widths[TriangleId(i)] = boxes[bodies.of_triangle[TriangleId(i)]].middle_side();
  return widths;
}

}  // namespace halflight
