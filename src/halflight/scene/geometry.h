// The scene flattened to world space: every instance of every primitive as plain triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/scene/scene.h"

namespace halflight {

using TriangleId = Id<struct TriangleTag>;
using VertexId = Id<struct VertexTag>;
using InstanceId = Id<struct InstanceTag>;

// Metres from the origin: beyond, areas and distances overflow single precision somewhere.
inline constexpr float kFarthest = 1e9f;

// One placed primitive: what one lit primitive of the output stands for.
struct PrimitiveInstance {
  NodeId node;
  std::uint32_t copy = 0;  // which of node.instances; 0 without instancing
  MeshId mesh;
  std::uint32_t primitive = 0;
  IdRange<VertexId> vertices;
  IdRange<TriangleId> triangles;
};

struct PunctualLight {
  Light::Kind kind = Light::Kind::point;
  Vec3 position{0.f};
  Vec3 direction{0.f, 0.f, -1.f};  // the way the light travels, unit
  Rgb intensity{0.f};              // candela or lux
  float range = kInfinity;
  float cos_inner = 1.f;
  float cos_outer = 0.f;
  LightId light;  // that was placed here
};

struct PlacedCamera {
  std::string name;
  Vec3 position{0.f};
  Vec3 forward{0.f, 0.f, -1.f};
  Vec3 up{0.f, 1.f, 0.f};
  bool perspective = true;
  float vertical_fov = 0.8f;  // radians
  float aspect = 0.f;         // 0: that of the picture
  float half_height = 1.f;    // orthographic, metres
};

struct Geometry {
  IdVector<VertexId, Vec3> positions;
  // Shading normals, unit, zero where the file has none; and texture coordinates. Empty where no
  // vertex of the file has any.
  IdVector<VertexId, Vec3> normals;
  std::array<IdVector<VertexId, Vec2>, 2> uvs;
  IdVector<TriangleId, std::array<VertexId, 3>>
      triangles;  // non-degenerate, front counter-clockwise
  IdVector<TriangleId, MaterialId> materials;
  IdVector<TriangleId, InstanceId> instances;
  IdVector<InstanceId, PrimitiveInstance> primitive_instances;
  std::vector<PunctualLight> lights;
  std::vector<PlacedCamera> cameras;
  Bounds3f bounds;
  // Left out: of less than 5e-16 m2, not finite, or beyond kFarthest; lights that
  // their node leaves without a direction or puts beyond it.
  std::size_t degenerate_triangles = 0;
  std::size_t lights_without_place = 0;

  Vec3 normal(VertexId v) const { return normals.empty() ? Vec3(0.f) : normals[v]; }
  Vec2 uv(std::size_t set, VertexId v) const { return uvs[set].empty() ? Vec2(0.f) : uvs[set][v]; }
  std::array<Vec3, 3> corners(TriangleId t) const {
    const auto& v = triangles[t];
    return {positions[v[0]], positions[v[1]], positions[v[2]]};
  }
  // Not normalised: its length is twice the triangle's area.
  Vec3 scaled_normal(TriangleId t) const {
    const auto [a, b, c] = corners(t);
    return glm::cross(b - a, c - a);
  }
  // At barycentric weights of the 2nd and 3rd corner.
  Vec3 point(TriangleId t, Vec2 weights) const {
    const auto [a, b, c] = corners(t);
    return a + weights.x * (b - a) + weights.y * (c - a);
  }
  float area(TriangleId t) const { return 0.5f * glm::length(scaled_normal(t)); }
  // Weights of the 2nd and 3rd corner at a point in the triangle's plane.
  Vec2 barycentric(TriangleId t, const Vec3& p) const {
    const auto [a, b, c] = corners(t);
    const Vec3 n = glm::cross(b - a, c - a);
    const float area = glm::dot(n, n);
    return {glm::dot(glm::cross(p - a, c - a), n) / area,
            glm::dot(glm::cross(b - a, p - a), n) / area};
  }
};

Geometry flatten(const Scene& scene);
// By how much rays begin and end off surfaces, metres: more than the rounding error of coordinates.
float lift_distance(const Bounds3f& bounds);
// Whether the camera has a place within kFarthest, directions and an angle: nodes of no size or far
// away leave it without.
bool can_look(const PlacedCamera& camera);
// The same geometry with the punctual lights as bright as in this scene.
Geometry with_lights_of(const Scene& scene, Geometry geometry);

// Material properties at a point of a triangle given by barycentric weights of its 2nd and 3rd
// corner.
Rgb reflectance_at(const Scene&, const Geometry&, TriangleId, Vec2 barycentric);  // within [0, 1]
Rgb emission_at(const Scene&, const Geometry&, TriangleId, Vec2 barycentric);     // radiance
float opacity_at(const Scene&, const Geometry&, TriangleId, Vec2 barycentric);    // within [0, 1]
bool may_be_transparent(const Material&);  // false: opacity_at is 1 everywhere

}  // namespace halflight
