// What a path tracer asks of shadows, so that approximate answers can be tried in it.
#pragma once

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

class ShadowTest {
 public:
  virtual ~ShadowTest() = default;
  // Share of the light that arrives at `from` from a place on an emitter (of a triangle; invalid: a
  // punctual light), in [0, 1].
  virtual float from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const = 0;
  // The same from a directional light; unit direction towards it.
  virtual float from_direction(const Vec3& from, const Vec3& direction) const = 0;
};

}  // namespace halflight
