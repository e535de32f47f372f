// Builds the nodes of the multi-resolution tree over a cluster tree.
#pragma once

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/visibility/multires_nodes.h"

namespace halflight {

// Inner nodes follow the clusters. Clusters with few members are merged into the node above while
// that has room; more than eight members get nodes between by a binned surface area heuristic
// (Wald 2007), and so do surfaces of many triangles.
MultiresNodes build_multires_nodes(const Scene& scene, const Geometry& geometry,
                                   const Surfaces& surfaces, const ClusterTree& clusters);

// A cluster tree that leaves all grouping to the heuristic. Rays are faster through the result than
// through builders that group by size (up to 1.5 times), but the clusters of a
// solver then are not the nodes where rays stop.
ClusterTree one_cluster(const Surfaces& surfaces);

}  // namespace halflight
