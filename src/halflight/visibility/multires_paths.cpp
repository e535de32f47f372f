#include "halflight/visibility/multires_paths.h"

namespace halflight {

MultiresPaths::MultiresPaths(const Visibility& visibility, float feature_size, BounceRays bounces)
    : visibility_(&visibility), feature_size_(feature_size) {
  if (bounces == BounceRays::clusters && visibility.tree() && feature_size > 0.f)
    sampler_.emplace(visibility.world(), *visibility.tree());
}

float MultiresPaths::from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const {
  const float size = emitter.valid() ? visibility_->emitter_size(emitter, from, to) : 0.f;
  return visibility_->transmittance({from, to, feature_size_, size});
}

float MultiresPaths::from_direction(const Vec3& from, const Vec3& direction) const {
  return visibility_->transmittance_to_sky(from, direction, feature_size_, 0.f);
}

std::optional<RayHit> MultiresPaths::next_surface(const Vec3& from, const Vec3& direction,
                                                  std::uint64_t seed) const {
  const RayScene& exact = visibility_->world().rays;
  if (!sampler_) return exact.closest_hit(from, direction, kInfinity, seed);
  const auto hit = visibility_->closest_hit(from, direction, kInfinity, feature_size_, 0.f, seed);
  if (!hit) return std::nullopt;
  if (!hit->in_cluster()) return hit->surface;
  const auto seen = sampler_->visible_point(hit->slot, direction, seed);
  return seen ? seen : exact.closest_hit(from, direction, kInfinity, seed);
}

}  // namespace halflight
