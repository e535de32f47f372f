// The light that a cluster sends along a direction is the mean over what is seen of its contents
// from there. A path that is absorbed in the cluster has that mean when it goes on from a point
// drawn from what is seen: nothing has to be stored, and direct light and all further bounces at
// the point are those of the surface itself.
#pragma once

#include <optional>
#include <vector>

#include "halflight/rays/world.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight {

// Thread-safe. Refers to both.
class ClusterSampler {
 public:
  ClusterSampler(const World& world, const MultiresTree& tree);

  // A point of the surfaces below a slot (MediumHit::slot), uniform over the area that parallel
  // rays along the unit direction meet first, as if nothing else were in the scene. A surface of
  // opacity a is met with probability a. None when nothing was met in many tries, as where all is
  // seen edge on. Of surfaces that touch, such as books of a stack, either may be taken for the
  // first. `distance` of the answer means nothing.
  std::optional<RayHit> visible_point(std::uint32_t slot, const Vec3& direction,
                                      std::uint64_t seed) const;

 private:
  // Uniform over the triangles below the slot.
  RayHit any_point(std::uint32_t slot, std::uint64_t seed) const;

  const World* world_;
  const MultiresTree* tree_;
  std::vector<double> area_before_;  // of each block, and of all
};

}  // namespace halflight
