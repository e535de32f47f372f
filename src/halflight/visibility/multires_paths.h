// Light paths by any of the three visibilities: the paper's future work, Monte Carlo with
// multi-resolution visibility (section 7).
#pragma once

#include "halflight/rays/path_rays.h"
#include "halflight/visibility/cluster_sampler.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

enum class BounceRays : std::uint8_t {
  exact,    // only shadow rays know of clusters
  clusters  // a path that is absorbed in a cluster goes on from what is seen of its contents
};

class MultiresPaths final : public PathRays {
 public:
  // Refers to the visibility.
  MultiresPaths(const Visibility& visibility, float feature_size,
                BounceRays bounces = BounceRays::exact);

  float from_emitter(const Vec3& from, const Vec3& to, TriangleId emitter) const override;
  float from_direction(const Vec3& from, const Vec3& direction) const override;
  std::optional<RayHit> next_surface(const Vec3& from, const Vec3& direction,
                                     std::uint64_t seed) const override;

 private:
  const Visibility* visibility_;
  float feature_size_;
  std::optional<ClusterSampler> sampler_;  // none: exact bounces
};

}  // namespace halflight
