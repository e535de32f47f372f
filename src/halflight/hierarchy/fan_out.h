// Clusters of too many members get clusters between.
#pragma once

#include <span>

#include "halflight/hierarchy/cluster_tree.h"

namespace halflight {

// Surfaces attached to a cluster of more than `largest` members (at least 4) are grouped along the
// Morton curve. Builders call this on trees whose clusters have at most half as many children.
void limit_fan_out(ClusterTree& tree, std::span<const Bounds3f> surface_boxes, std::size_t largest);

}  // namespace halflight
