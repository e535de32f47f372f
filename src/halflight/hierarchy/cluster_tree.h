// What a hierarchy builder makes: clusters of surfaces, each surface in exactly one cluster.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/hierarchy/surfaces.h"

namespace halflight {

struct ClusterTree {
  struct Cluster {
    std::vector<std::uint32_t> clusters;  // children, indices into `clusters` below
    std::vector<SurfaceId> surfaces;      // attached directly
  };
  std::vector<Cluster> clusters;
  std::uint32_t root = 0;
  // The space that the builder gave each cluster, where that is more than its members' boxes (cells
  // of a k-d tree); else empty.
  std::vector<Bounds3f> volumes;
};

}  // namespace halflight
