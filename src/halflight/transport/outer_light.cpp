#include "halflight/transport/outer_light.h"

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

// Perpendicular irradiance from one light, and the unit direction towards it.
Rgb unoccluded(const PunctualLight& light, const Vec3& x, Vec3& towards, float& distance) {
  if (light.kind == Light::Kind::directional) {
    towards = -light.direction;
    distance = kInfinity;
    return light.intensity;
  }
  const Vec3 between = light.position - x;
  distance = glm::length(between);
  if (!(distance > 0.f)) return Rgb(0.f);
  towards = between / distance;
  float share = 1.f / (distance * distance);
  if (std::isfinite(light.range)) {
    const float ratio = distance / light.range;
    share *= std::clamp(1.f - ratio * ratio * ratio * ratio, 0.f, 1.f);
  }
  if (light.kind == Light::Kind::spot) {
    const float cosine = glm::dot(-towards, light.direction);
    const float blend = std::clamp(
        (cosine - light.cos_outer) / std::max(0.001f, light.cos_inner - light.cos_outer), 0.f, 1.f);
    share *= blend * blend;
  }
  return share * light.intensity;
}

}  // namespace

Rgb punctual_irradiance(const World& world, const Vec3& x, const Vec3& n) {
  Rgb sum(0.f);
  const Vec3 from = world.rays.lift(x, n);
  for (const PunctualLight& light : world.geometry.lights) {
    Vec3 towards(0.f);
    float distance = 0.f;
    const Rgb e = unoccluded(light, x, towards, distance);
    const float cosine = glm::dot(n, towards);
    if (cosine <= 0.f || !(max_component(e) > 0.f)) continue;
    const float visible = std::isfinite(distance) ? world.rays.transmittance(from, light.position)
                                                  : world.rays.transmittance_to_sky(from, towards);
    sum += visible * cosine * e;
  }
  return sum;
}

Rgb sky_irradiance(const World& world, const Vec3& x, const Vec3& n, int samples, Vec2 shift) {
  if (!(max_component(world.scene.sky) > 0.f)) return Rgb(0.f);
  const Frame frame = Frame::from_normal(n);
  const Vec3 from = world.rays.lift(x, n);
  float open = 0.f;
  for (int k = 0; k < samples; ++k) {
    const Vec3 w = cosine_hemisphere(r2_sequence(static_cast<std::uint32_t>(k), shift));
    open += world.rays.transmittance_to_sky(from, frame.to_world(w));
  }
  return kPi * world.scene.sky * (open / static_cast<float>(samples));
}

}  // namespace halflight
