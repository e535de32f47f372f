// What a punctual light sends to a point, as KHR_lights_punctual says.
#pragma once

#include <algorithm>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Share of the intensity that leaves a spot at the given cosine to its axis: 1 inside the inner
// cone, 0 outside the outer one, the square of a linear ramp in the cosine between them.
inline float spot_falloff(const PunctualLight& light, float cos_axis) {
  const float scale = 1.f / std::max(1e-3f, light.cos_inner - light.cos_outer);
  const float ramp = std::clamp((cos_axis - light.cos_outer) * scale, 0.f, 1.f);
  return ramp * ramp;
}

// Window of a limited range: max(0, min(1, 1 - (d / range)^4)).
inline float range_window(float distance, float range) {
  const float ratio = distance / range;
  return std::clamp(1.f - ratio * ratio * ratio * ratio, 0.f, 1.f);
}

// Unoccluded irradiance, lux, on a surface at `point` that faces the light squarely. Point and
// spot: I / d^2; directional: its illuminance.
inline Rgb facing_irradiance(const PunctualLight& light, const Vec3& point) {
  if (light.kind == Light::Kind::directional) return light.intensity;
  const Vec3 away = point - light.position;
  const float distance_squared = glm::dot(away, away);
  if (!(distance_squared > 0.f)) return Rgb(0.f);
  const float distance = std::sqrt(distance_squared);
  float share = range_window(distance, light.range) / distance_squared;
  if (light.kind == Light::Kind::spot)
    share *= spot_falloff(light, glm::dot(away, light.direction) / distance);
  return light.intensity * share;
}

// Unit direction from the point towards the light.
inline Vec3 direction_to(const PunctualLight& light, const Vec3& point) {
  if (light.kind == Light::Kind::directional) return -light.direction;
  return glm::normalize(light.position - point);
}

}  // namespace halflight
