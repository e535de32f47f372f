// How good a cluster tree is: for visibility, by the paper's two properties, and for its cost.
#pragma once

#include <array>
#include <cstddef>

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/rays/world.h"

namespace halflight {

// Clusters whose box's diagonal is between two shares of the scene's.
struct ExtinctionQuality {
  double largest = 0.0;      // share; the next class begins at a quarter of it
  std::size_t clusters = 0;  // of this size; up to a few hundred of them are tried
  // Mean transmittance of lines through the box as a medium (extinction by area) less the exact
  // one through the cluster's own surfaces: mean and root mean square over clusters, weighted by
  // the surface areas of their boxes, that is by how often rays meet them.
  double bias = 0.0;
  double rms = 0.0;
};

// Rays between points spread over all surfaces, on one core.
struct RayQuality {
  double nodes = 0.0;  // for each ray, eight clusters at once
  double per_second = 0.0;
  double mean = 0.0;  // transmittance
  double rms = 0.0;   // of the difference from the exact answer, ray by ray
};

struct HierarchyMeasures {
  std::size_t clusters = 0;
  int depth = 0;         // levels of clusters
  double fan_out = 0.0;  // members of a cluster, mean
  std::size_t largest_fan_out = 0;
  double empty_space = 0.0;  // 1 - sum of members' volumes / volume, mean over clusters
  double size_spread = 0.0;  // octaves between the members' sizes, standard deviation, mean
  std::array<ExtinctionQuality, 4> extinction;
  RayQuality exact;    // surfaces tested exactly in the same tree
  RayQuality average;  // at a feature size of 1 % of the scene's diagonal, from a point
  RayQuality multires;
  std::size_t bytes = 0;             // of the cluster tree
  std::size_t visibility_bytes = 0;  // of the tree that rays walk
};

HierarchyMeasures measure_hierarchy(const World& world, const Surfaces& surfaces,
                                    const ClusterTree& tree);

}  // namespace halflight
