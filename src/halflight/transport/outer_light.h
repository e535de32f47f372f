// Light from sources that are no surface: punctual lights and the constant sky.
#pragma once

#include <cstdint>

#include "halflight/base/vec.h"
#include "halflight/rays/world.h"

namespace halflight {

inline bool has_outer_light(const World& world) {
  return !world.geometry.lights.empty() || max_component(world.scene.sky) > 0.f;
}

// Irradiance at a point with unit normal n from point, spot and directional lights, shadows by one
// exact ray each (KHR_lights_punctual: candela / r^2, lux; range and cones as recommended there).
Rgb punctual_irradiance(const World& world, const Vec3& x, const Vec3& n);

// Irradiance from the sky seen through `samples` cosine-distributed exact rays.
Rgb sky_irradiance(const World& world, const Vec3& x, const Vec3& n, int samples, Vec2 shift);

}  // namespace halflight
