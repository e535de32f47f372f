// Clusters from the surfaces up: neighbours along the Morton curve that go best together merge, all
// mutual choices of a round at once (locally-ordered clustering, Meister and Bittner 2018), with
// the paper's two properties of good clusters, proximity and homogeneity, in the choice.
#pragma once

#include <cstdint>
#include <span>

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/hierarchy/surface_shape.h"

namespace halflight {

// The cost of a cluster u made of a and b, smaller is better:
//   S(u) (1 + size * |log2(L(a) / L(b))|) (1 + orientation * (1 - |N(u)| / A(u)))
// S surface area of the box, L its longest side, N the sum of area times normal, A of areas.
struct AgglomerativeOptions {
  int search_radius = 8;  // places along the curve looked at on either side
  float size_weight = 0.5f;
  float orientation_weight = 0.25f;
  // Surfaces of a connected body merge with each other before others, unless it is longer than this
  // share of the scene: walls are not an object.
  float largest_object = 0.25f;
  std::size_t largest_fan_out = 8;
};

ClusterTree build_agglomerative(std::span<const SurfaceShape> shapes,
                                const AgglomerativeOptions& options = {},
                                std::uint64_t* steps = nullptr);

}  // namespace halflight
