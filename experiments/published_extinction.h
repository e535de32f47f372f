// Average visibility word for word: every surface is a medium that fills the cluster it is attached
// to, wherever the ends of the ray are. For figure 8; visibility/multires_tree.h is what to use.
#pragma once

#include <vector>

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/rays/world.h"

namespace halflight::experiments {

class PublishedExtinction {
 public:
  // The walls of the room, seen from inside, and emitters weaken nothing.
  PublishedExtinction(const World& world, const Surfaces& surfaces, const ClusterTree& tree);

  // exp(-sum of kappa_i l_i) over the clusters between two points.
  float transmittance(const Vec3& from, const Vec3& to) const;

 private:
  struct Medium {
    Bounds3f box;            // of the cluster and all below
    float extinction = 0.f;  // by its own surfaces, 1/m
    std::uint32_t first_child = 0, child_count = 0;
  };
  std::vector<Medium> media_;
};

}  // namespace halflight::experiments
