#include "halflight/visibility/multires_shadows.h"

#include "halflight/visibility/emitter_widths.h"

namespace halflight {

MultiresShadows::MultiresShadows(const Visibility& visibility, float feature_size)
    : visibility_(&visibility),
      feature_size_(feature_size),
      widths_(emitter_widths(visibility.world())) {}

float MultiresShadows::from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const {
  float width = 0.f;
  if (emitter.valid()) {
    const Vec3 normal = glm::normalize(visibility_->world().geometry.scaled_normal(emitter));
    width = widths_[emitter] * std::abs(glm::dot(glm::normalize(from - to), normal));
  }
  return visibility_->transmittance({from, to, feature_size_, width});
}

float MultiresShadows::from_direction(const Vec3& from, const Vec3& direction) const {
  return visibility_->transmittance_to_sky(from, direction, feature_size_, 0.f);
}

}  // namespace halflight
