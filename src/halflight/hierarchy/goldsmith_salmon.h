// Goldsmith and Salmon 1987: surfaces enter the tree one by one, each where it adds least to the
// expected cost of a ray. The hierarchy of Smits et al. 1994, before their changes.
#pragma once

#include <cstdint>
#include <span>

#include "halflight/hierarchy/cluster_tree.h"

namespace halflight {

struct GoldsmithSalmonOptions {
  int deepest = 48;  // surfaces that come this deep are attached there
};

ClusterTree build_goldsmith_salmon(std::span<const Bounds3f> surface_boxes,
                                   const GoldsmithSalmonOptions& options = {},
                                   std::uint64_t* steps = nullptr);

}  // namespace halflight
