// Exact visibility: the only files that name Embree are this header's source.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// A transmittance below this counts as blocked, and what is seen through less as not seen.
inline constexpr float kBlockedBelow = 1e-3f;

struct RayHit {
  TriangleId triangle;
  Vec2 barycentric{0.f};  // weights of the triangle's 2nd and 3rd corner
  float distance = 0.f;
  bool front = true;  // the ray met the counter-clockwise side
};

struct RayQuery {
  Vec3 origin{0.f}, direction{0.f};
  std::uint64_t seed = 0;
};

inline Vec3 hit_position(const Geometry& geometry, const RayHit& hit) {
  return geometry.point(hit.triangle, hit.barycentric);
}

// Unit, towards the side that the ray met.
inline Vec3 hit_normal(const Geometry& geometry, const RayHit& hit) {
  return glm::normalize(geometry.scaled_normal(hit.triangle)) * (hit.front ? 1.f : -1.f);
}

// Ray queries against the flattened scene. Surfaces of opacity below 1 let light straight through
// with weight 1 - opacity. Refers to scene and geometry: they must outlive it. Thread-safe.
class RayScene {
 public:
  RayScene(const Scene& scene, const Geometry& geometry);
  ~RayScene();
  // Shares what was built; `owner` keeps the other's scene and geometry.
  RayScene(const RayScene& other, std::shared_ptr<const void> owner);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  // Product of 1 - opacity over everything strictly between the two points; 0 when blocked.
  float transmittance(const Vec3& from, const Vec3& to) const;
  // The same from a point to infinity (sky, directional lights).
  float transmittance_to_sky(const Vec3& from, const Vec3& direction) const;
  // Nearest surface that stops the ray. A surface of opacity a stops it with probability a, decided
  // by a hash of the seed and the triangle, so that the answer is repeatable.
  std::optional<RayHit> closest_hit(const Vec3& origin, const Vec3& direction, float max_distance,
                                    std::uint64_t seed) const;
  // The same of many rays to infinity, which are traced in an order that suits the cache.
  std::vector<std::optional<RayHit>> closest_hits(std::span<const RayQuery> queries) const;
  // Nearest surface, however little of the light it stops.
  std::optional<RayHit> first_surface(const Vec3& origin, const Vec3& direction,
                                      float max_distance) const;

  // Triangles that come within `radius` of the point, and perhaps a few more; in rising order.
  std::vector<TriangleId> triangles_near(const Vec3& point, float radius) const;

  // Lifts a point off its surface, on the side that the unit normal n points to, by more than the
  // rounding error of coordinates of this scene.
  Vec3 lift(const Vec3& p, const Vec3& n) const { return p + n * lift_distance_; }
  // The same of a light without a surface of its own, towards what it shines at: it may lie in that
  // of a lamp or a ceiling.
  Vec3 lift_towards(const Vec3& light, const Vec3& x) const {
    return light + (x - light) * std::min(1.f, lift_distance_ / glm::distance(x, light));
  }
  float lift_distance() const { return lift_distance_; }
  // Rays traced so far, of all kinds.
  std::uint64_t ray_total() const;
  // Names the instruction set that the answers depend on; part of the determinism promise.
  static const char* instruction_set();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
  std::shared_ptr<const void> owner_;
  float lift_distance_ = 0.f;
};

}  // namespace halflight
