#include "halflight/visibility/visibility.h"

#include "halflight/visibility/emitter_widths.h"

namespace halflight {

std::string_view name_of(VisibilityMode mode) {
  for (const NamedVisibilityMode& m : kVisibilityModes)
    if (m.mode == mode) return m.name;
  return {};
}

Visibility::Visibility(const World& world, const Surfaces& surfaces, const ClusterTree& clusters,
                       VisibilityMode mode, const MultiresOptions& options)
    : world_(&world), mode_(mode) {
  if (mode == VisibilityMode::exact) return;
  tree_ = std::make_shared<MultiresTree>(world.scene, world.geometry, surfaces, clusters, options);
  emitter_widths_ = emitter_widths(world, surfaces.bodies);
}

float Visibility::emitter_size(TriangleId triangle, const Vec3& receiver,
                               const Vec3& emitter) const {
  if (mode_ == VisibilityMode::exact) return 0.f;
  const Vec3 normal = glm::normalize(world_->geometry.scaled_normal(triangle));
  return emitter_widths_[triangle] * std::abs(glm::dot(glm::normalize(receiver - emitter), normal));
}

float Visibility::through_tree(const VisibilityRay& ray, const StopRule& rule) const {
  TraversalCount count;
  const float share = mode_ == VisibilityMode::average ? tree_->average(ray, rule, &count)
                                                       : tree_->multires(ray, rule, &count);
  counts_->rays.add();
  counts_->nodes.add(count.nodes);
  return share;
}

float Visibility::transmittance(const RayEnds& ends) const {
  if (exact(ends.feature_size)) return world_->rays.transmittance(ends.receiver, ends.emitter);
  return through_tree({ends.receiver, ends.emitter - ends.receiver, 1.f},
                      StopRule::between(ends.feature_size, ends.emitter_size));
}

float Visibility::transmittance_to_sky(const Vec3& receiver, const Vec3& direction,
                                       float feature_size, float angular_diameter) const {
  if (exact(feature_size)) return world_->rays.transmittance_to_sky(receiver, direction);
  return through_tree({receiver, direction, kInfinity},
                      StopRule::widening(feature_size, angular_diameter));
}

std::optional<MediumHit> Visibility::closest_hit(const Vec3& receiver, const Vec3& direction,
                                                 float max_distance, float feature_size,
                                                 float spread, std::uint64_t seed) const {
  if (!exact(feature_size))
    return tree_->closest_hit({receiver, direction, max_distance},
                              StopRule::widening(feature_size, spread), seed);
  const auto hit = world_->rays.closest_hit(receiver, direction, max_distance, seed);
  if (!hit) return std::nullopt;
  return MediumHit{.surface = *hit, .distance = hit->distance};
}

}  // namespace halflight
