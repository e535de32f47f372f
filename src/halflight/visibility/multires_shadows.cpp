#include "halflight/visibility/multires_shadows.h"

namespace halflight {

float MultiresShadows::from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const {
  const float size = emitter.valid() ? visibility_->emitter_size(emitter, from, to) : 0.f;
  return visibility_->transmittance({from, to, feature_size_, size});
}

float MultiresShadows::from_direction(const Vec3& from, const Vec3& direction) const {
  return visibility_->transmittance_to_sky(from, direction, feature_size_, 0.f);
}

}  // namespace halflight
