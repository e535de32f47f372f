#include "halflight/rays/path_tracer.h"

#include <array>

#include "halflight/scene/punctual_light.h"

namespace halflight {
namespace {

constexpr std::uint32_t kBatches = 16;
// Roulette starts at this bounce and never lets a path live on with more than this probability.
constexpr int kFirstRoulette = 2;
constexpr float kHighestSurvival = 0.95f;

// Weight of a sample drawn with density a that could have been drawn with density b as well.
float power_heuristic(float a, float b) {
  if (!std::isfinite(a)) return 1.f;
  return a * a / (a * a + b * b);
}

// Far end of a shadow ray from p: off the light's surface.
Vec3 shadow_ray_end(const RayScene& rays, const Vec3& p, const LightSample& s) {
  return s.density > 0.f ? rays.lift(s.point, s.normal) : rays.lift_towards(s.point, p);
}

}  // namespace

SurfacePoint surface_point(const Geometry& geometry, const RayHit& hit) {
  return {hit_position(geometry, hit), hit_normal(geometry, hit)};
}

Rgb PathTracer::directional_light(const Vec3& p, const Vec3& n) const {
  Rgb total(0.f);
  for (const PunctualLight& light : emitters_.directional()) {
    const float cosine = -glm::dot(n, light.direction);
    if (!(cosine > 0.f)) continue;
    const float visible = rays_ ? rays_->from_direction(p, -light.direction)
                                : world_->rays.transmittance_to_sky(p, -light.direction);
    total += light.intensity * (cosine * visible);
  }
  return total;
}

Rgb PathTracer::sampled_light(const Vec3& p, const Vec3& n, PathSampler& sampler) const {
  const float u_light = sampler.next_pair().x;
  const auto s = emitters_.sample(p, n, u_light, sampler.next_pair());
  if (!s) return Rgb(0.f);
  const Vec3 end = shadow_ray_end(world_->rays, p, *s);
  if (rays_) return s->irradiance * rays_->from_emitter(p, end, s->triangle);
  float weight = 1.f;
  if (s->density > 0.f) {
    const float cosine = glm::dot(n, glm::normalize(s->point - p));
    weight = power_heuristic(s->density, std::max(0.f, cosine) / kPi);
  }
  return s->irradiance * (weight * world_->rays.transmittance(p, end));
}

// E = light samples + pi * (radiance along a cosine-distributed ray), and that radiance is
// emission + rho / pi * E at the point it comes from.
Rgb PathTracer::irradiance_by_one_path(Vec3 p, Vec3 n, PathSampler& sampler,
                                       const KnownRadiosity& known) const {
  Rgb total(0.f), weight(1.f);
  for (int bounce = 0;; ++bounce) {
    const Vec3 origin = world_->rays.lift(p, n);
    total += weight * (directional_light(origin, n) + sampled_light(origin, n, sampler));

    const Vec3 local = cosine_hemisphere(sampler.next_pair());
    const Vec3 direction = Frame::from_normal(n).to_world(local);
    const std::uint64_t seed = sampler.next_seed();
    const auto hit = rays_ ? rays_->next_surface(origin, direction, seed)
                           : world_->rays.closest_hit(origin, direction, kInfinity, seed);
    if (!hit) return total + weight * kPi * world_->scene.sky;

    const SurfacePoint next = surface_point(world_->geometry, *hit);
    const Rgb emitted = emitters_.radiance(hit->triangle, hit->barycentric, hit->front);
    if (max_component(emitted) > 0.f && !rays_) {
      const float by_light = emitters_.density(hit->triangle, origin, n, direction * hit->distance);
      total += weight * emitted * (kPi * power_heuristic(local.z / kPi, by_light));
    }
    if (known)
      if (const auto radiosity = known(*hit)) return total + weight * *radiosity;
    weight *= reflectance_at(world_->scene, world_->geometry, hit->triangle, hit->barycentric);
    const float survival = std::min(max_component(weight), kHighestSurvival);
    if (!(survival > 0.f)) return total;
    if (bounce >= kFirstRoulette) {
      if (to_unit_float(sampler.next_seed()) >= survival) return total;
      weight /= survival;
    }
    p = next.position;
    n = next.normal;
  }
}

IrradianceEstimate PathTracer::estimate_irradiance(const Vec3& point, const Vec3& normal,
                                                   std::uint32_t samples,
                                                   std::uint64_t seed) const {
  using Sum = glm::dvec3;
  const std::uint32_t batches = std::clamp(samples, 1u, kBatches);
  std::array<Sum, kBatches> means{};
  Sum total(0.0);
  for (std::uint32_t b = 0; b < batches; ++b) {
    const std::uint32_t size = samples / batches + (b < samples % batches ? 1 : 0);
    Sum sum(0.0);
    for (std::uint32_t i = 0; i < size; ++i) {
      PathSampler sampler(hash(seed, b), i);
      sum += Sum(irradiance_by_one_path(point, normal, sampler));
    }
    total += sum;
    means[b] = sum / static_cast<double>(std::max(1u, size));
  }
  const Sum mean = total / static_cast<double>(std::max(1u, samples));
  if (batches < 2) return {Rgb(mean), Rgb(kInfinity)};
  Sum squares(0.0);
  for (std::uint32_t b = 0; b < batches; ++b) squares += (means[b] - mean) * (means[b] - mean);
  return {Rgb(mean), Rgb(glm::sqrt(squares / (batches * (batches - 1.0))))};
}

Rgb PathTracer::radiance(const Vec3& origin, const Vec3& direction, PathSampler& sampler) const {
  const auto hit = world_->rays.closest_hit(origin, direction, kInfinity, sampler.next_seed());
  if (!hit) return world_->scene.sky;
  const Rgb emitted = emitters_.radiance(hit->triangle, hit->barycentric, hit->front);
  const Rgb reflectance =
      reflectance_at(world_->scene, world_->geometry, hit->triangle, hit->barycentric);
  if (!(max_component(reflectance) > 0.f)) return emitted;
  const SurfacePoint seen = surface_point(world_->geometry, *hit);
  return emitted + reflectance / kPi * irradiance_by_one_path(seen.position, seen.normal, sampler);
}

float PathTracer::direct_visibility(const Vec3& point, const Vec3& normal, std::uint32_t samples,
                                    std::uint64_t seed) const {
  const Vec3 origin = world_->rays.lift(point, normal);
  double unoccluded = 0.0, hidden = 0.0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    PathSampler sampler(seed, i);
    const float u_light = sampler.next_pair().x;
    const auto s = emitters_.sample(origin, normal, u_light, sampler.next_pair());
    if (!s) continue;
    const double light = average(s->irradiance) / static_cast<double>(samples);
    unoccluded += light;
    hidden += light *
              (1.0 - world_->rays.transmittance(origin, shadow_ray_end(world_->rays, origin, *s)));
  }
  for (const PunctualLight& light : emitters_.directional()) {
    const float cosine = std::max(0.f, -glm::dot(normal, light.direction));
    unoccluded += average(light.intensity) * cosine;
    hidden += average(light.intensity) * cosine *
              (1.f - world_->rays.transmittance_to_sky(origin, -light.direction));
  }
  return unoccluded > 0.0 ? static_cast<float>(1.0 - hidden / unoccluded) : 1.f;
}

}  // namespace halflight
