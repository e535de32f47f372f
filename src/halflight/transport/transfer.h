// The transfer of light between two elements, estimated from sampled point pairs: kernel and
// visibility come from the same pair, sources are sampled by their power down to their cells.
#pragma once

#include <cstdint>

#include "halflight/hierarchy/elements.h"
#include "halflight/transport/cluster_visibility.h"
#include "halflight/transport/link.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

// What the estimate needs to know; all referred to, nothing owned.
struct TransferScene {
  const ElementTree& tree;
  const Visibility& visibility;
  float feature_size;                         // of shadows on the receiver
  const IdVector<ElementId, Rgb>& radiosity;  // mean over the element's area
  const IdVector<ElementId, float>& opacity;  // of cells
  // Null: nothing is known of the inside of clusters.
  const ClusterVisibility* inside = nullptr;
};

// All weights are per unit of what the source shows to the receiver (sent_radiosity).

// Cheap geometry of a pair, before any ray.
struct TransferBounds {
  float largest_weight = 0.f;    // upper bound of the weight, 1 when the boxes touch
  float kernel_variation = 1.f;  // relative variation of the kernel over the pair, about 0 to 1
  bool touching = false;         // boxes overlap: no distance to speak of
};
TransferBounds bound_transfer(const ElementTree& tree, const ClusterVisibility* inside,
                              ElementId receiver, ElementId source);

// Neither faces the other: nothing can be transferred, whatever stands between.
bool back_facing(const ElementTree& tree, ElementId receiver, ElementId source);

struct TransferEstimate {
  float weight = 0.f;
  float unoccluded = 0.f;  // the weight had nothing stood between
  float deviation = 0.f;   // standard deviation of the weight over the sampled pairs
  PackedDirection direction;
};

// Mean over `samples` point pairs of R_r R_s V A_s / (pi r^2) (source points by power), where the
// cosine R of a receiving cluster is left to the distribution (1 for cells that face the source)
// and near cells use the closed-form polygon form factor. Different `stream`s give independent
// estimates.
TransferEstimate estimate_transfer(const TransferScene& scene, ElementId receiver, ElementId source,
                                   int samples, std::uint64_t stream);

// The same for pairs that touch, where that kernel is singular: the share of cosine-distributed
// rays from the receiver that meet the source, weighted by what they meet. Bounded by 1. A
// receiving cluster gets it from all around.
TransferEstimate estimate_touching_transfer(const TransferScene& scene, ElementId receiver,
                                            ElementId source, int samples, std::uint64_t stream);

}  // namespace halflight
