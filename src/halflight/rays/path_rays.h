// What a path tracer asks of visibility, so that approximate answers can be tried in it.
#pragma once

#include <cstdint>
#include <optional>

#include "halflight/rays/ray_scene.h"

namespace halflight {

class PathRays {
 public:
  virtual ~PathRays() = default;
  // Share of the light that arrives at `from` from a place on an emitter (of a triangle; invalid: a
  // punctual light), in [0, 1].
  virtual float from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const = 0;
  // The same from a directional light; unit direction towards it.
  virtual float from_direction(const Vec3& from, const Vec3& direction) const = 0;
  // The surface that a path goes on from which leaves `from` along a unit direction; none: it
  // leaves the scene. The answer need not lie on the ray.
  virtual std::optional<RayHit> next_surface(const Vec3& from, const Vec3& direction,
                                             std::uint64_t seed) const = 0;
};

}  // namespace halflight
