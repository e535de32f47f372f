// The baseline of Sillion 1994: cells of a k-d tree are the clusters, and what straddles a cutting
// plane stays in the cell above, however small it is.
#pragma once

#include <cstdint>
#include <span>

#include "halflight/hierarchy/cluster_tree.h"

namespace halflight {

struct KdTreeOptions {
  std::size_t most_in_cell = 8;     // cells of no more surfaces are not cut
  std::size_t largest_fan_out = 8;  // what straddles is grouped when a cell holds more members
  // As published: clusters fill their whole cells, with all that straddles attached at once.
  bool whole_cells = false;
};

ClusterTree build_kd_tree(std::span<const Bounds3f> surface_boxes,
                          const KdTreeOptions& options = {}, std::uint64_t* steps = nullptr);

}  // namespace halflight
