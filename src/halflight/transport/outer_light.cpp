#include "halflight/transport/outer_light.h"

#include "halflight/rays/adaptive_hemisphere.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/punctual_light.h"

namespace halflight {

float punctual_visibility(const Visibility& visibility, const PunctualLight& light,
                          const Vec3& from, const Vec3& towards, float feature_size) {
  if (light.kind == Light::Kind::directional)
    return visibility.transmittance_to_sky(from, towards, feature_size, 0.f);
  const Vec3 to = visibility.world().rays.lift_towards(light.position, from);
  return visibility.transmittance({from, to, feature_size, 0.f});
}

Rgb punctual_irradiance(const Visibility& visibility, const Vec3& x, const Vec3& n,
                        float feature_size) {
  const World& world = visibility.world();
  Rgb sum(0.f);
  const Vec3 from = world.rays.lift(x, n);
  for (const PunctualLight& light : world.geometry.lights) {
    const Rgb e = facing_irradiance(light, x);
    if (!(max_component(e) > 0.f)) continue;
    const Vec3 towards = direction_to(light, x);
    const float cosine = glm::dot(n, towards);
    if (cosine <= 0.f) continue;
    const float visible = punctual_visibility(visibility, light, from, towards, feature_size);
    sum += visible * cosine * e;
  }
  return sum;
}

Rgb sky_irradiance(const Visibility& visibility, const Vec3& x, const Vec3& n, int samples,
                   Vec2 shift, float feature_size) {
  const World& world = visibility.world();
  if (!(max_component(world.scene.sky) > 0.f)) return Rgb(0.f);
  const Frame frame = Frame::from_normal(n);
  const Vec3 from = world.rays.lift(x, n);
  const auto angle_of = [](float rays) { return std::sqrt(2.f * kPi / rays); };  // between rays
  return kPi * world.scene.sky *
         adaptive_cosine_mean(samples, shift, [&](const Vec3& w, float rays) {
           return Rgb(visibility.transmittance_to_sky(from, frame.to_world(w), feature_size,
                                                      angle_of(rays)));
         });
}

}  // namespace halflight
