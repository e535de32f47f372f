// Light from sources that are no surface: punctual lights and the constant sky.
#pragma once

#include <cstdint>

#include "halflight/base/vec.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

inline bool has_outer_light(const World& world) {
  return !world.geometry.lights.empty() || max_component(world.scene.sky) > 0.f;
}

// The share of a punctual light that arrives at `from`, a point lifted off its surface; `towards`
// is the direction to the light, of directional ones.
float punctual_visibility(const Visibility& visibility, const PunctualLight& light,
                          const Vec3& from, const Vec3& towards, float feature_size);

// Irradiance at a point with unit normal n from point, spot and directional lights, shadows
// of at least the feature size by one ray each (KHR_lights_punctual: candela / r^2, lux; range and
// cones as recommended there).
Rgb punctual_irradiance(const Visibility& visibility, const Vec3& x, const Vec3& n,
                        float feature_size);

// Irradiance from the sky seen through `samples` cosine-distributed rays; many of them see where
// its edges are and send as many again there.
Rgb sky_irradiance(const Visibility& visibility, const Vec3& x, const Vec3& n, int samples,
                   Vec2 shift, float feature_size);

}  // namespace halflight
