// Shadows of path-traced light by any of the three visibilities: the paper's future work, Monte
// Carlo with multi-resolution visibility (section 7).
#pragma once

#include "halflight/rays/shadow_test.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

class MultiresShadows final : public ShadowTest {
 public:
  // Refers to the visibility.
  MultiresShadows(const Visibility& visibility, float feature_size)
      : visibility_(&visibility), feature_size_(feature_size) {}

  float from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const override;
  float from_direction(const Vec3& from, const Vec3& direction) const override;

 private:
  const Visibility* visibility_;
  float feature_size_;
};

}  // namespace halflight
