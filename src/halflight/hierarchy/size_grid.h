// The paper's own hierarchy (section 4.1): objects enter a stack of uniform grids by size, and from
// the finest grid upwards are grouped by proximity (least empty space) into clusters.
#pragma once

#include <cstdint>
#include <span>

#include "halflight/hierarchy/cluster_tree.h"

namespace halflight {

struct SizeGridOptions {
  // Strict: an object belongs to a voxel that holds it wholly, and those that straddle voxels join
  // a cluster or are promoted (the paper). Loose: it belongs to the voxel of its centre.
  bool strict = false;
  float largest_empty_share = 0.6f;  // e = 1 - (V(a) + V(b)) / V(a u b) accepted for a merge
  float tiny_share = 0.25f;          // of the voxel's side: smaller objects are grouped regardless
  int largest_fan_out = 8;
};

ClusterTree build_size_grid(std::span<const Bounds3f> surface_boxes,
                            const SizeGridOptions& options = {}, std::uint64_t* steps = nullptr);

}  // namespace halflight
