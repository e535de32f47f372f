// Planar surfaces: connected coplanar triangles of one material, taken as one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/hierarchy/bodies.h"
#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"

namespace halflight {

using SurfaceId = Id<struct SurfaceTag>;
// One side of a surface: 2 * surface for the front, 2 * surface + 1 for the back.
using SideId = Id<struct SideTag>;

inline SideId side_of(SurfaceId s, bool back) { return SideId(2 * s.value + (back ? 1 : 0)); }
inline SurfaceId surface_of(SideId s) { return SurfaceId(s.value / 2); }
inline bool is_back(SideId s) { return s.value % 2 != 0; }

struct Surface {
  Vec3 origin{0.f};      // of the plane's (u, v) coordinates
  Vec3 axis_u{1, 0, 0};  // unit, in the plane
  Vec3 axis_v{0, 1, 0};  // unit, in the plane; axis_u x axis_v = normal
  Vec3 normal{0, 0, 1};  // of the front side
  Vec2 uv_lower{0.f};    // bounding rectangle in the plane
  Vec2 uv_upper{0.f};
  float area = 0.f;
  MaterialId material;
  Bounds3f box;
  std::uint32_t first_triangle = 0;  // into Surfaces::triangles
  std::uint32_t triangle_count = 0;

  Vec2 to_plane(const Vec3& p) const {
    return {glm::dot(p - origin, axis_u), glm::dot(p - origin, axis_v)};
  }
  Vec3 to_world(Vec2 uv) const { return origin + uv.x * axis_u + uv.y * axis_v; }
};

struct Surfaces {
  IdVector<SurfaceId, Surface> surfaces;
  std::vector<TriangleId> triangles;   // grouped by surface
  std::vector<float> cumulative_area;  // within its surface, after each of `triangles`
  IdVector<TriangleId, SurfaceId> of_triangle;
  Bodies bodies;  // what hangs together, in one plane or not

  const Surface& operator[](SurfaceId id) const { return surfaces[id]; }
  const Surface& operator[](SideId id) const { return surfaces[surface_of(id)]; }
  SideId side_hit(const RayHit& hit) const {
    return side_of(of_triangle[hit.triangle], !hit.front);
  }
  Vec3 normal(SideId id) const {
    const Vec3 n = surfaces[surface_of(id)].normal;
    return is_back(id) ? -n : n;
  }
};

// Elements then are cells of the surface, whatever triangles the file cut it into. Surfaces are
// numbered along a space-filling curve: what is near in space is near in memory.
Surfaces build_surfaces(const Geometry& geometry);

}  // namespace halflight
