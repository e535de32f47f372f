// Links made by rays: a receiver shoots a few rays and stores what they hit. Kernel and visibility
// come jointly, rows add up to what does not leave the scene, and there is no singularity; the
// price is noise, which later averages remove. Such links carry reflected light only: light
// straight from emitters is read exactly (emitter_tree.h).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/transport/cluster_visibility.h"
#include "halflight/transport/emitter_tree.h"
#include "halflight/transport/link.h"
#include "halflight/transport/spherical_harmonics.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

struct SampledLinkOptions {
  int rays_per_cell = 64;
  int rays_per_cluster = 128;
  int shadow_rays_per_cluster = 32;  // to emitters, as many to the sky, one to each punctual light
  // A receiver of this area (m2) takes all of these, others fewer or more by the square root of
  // theirs: what small ones send on is averaged with much else, large ones few others make up for.
  // 0: all take the same.
  float area_of_all_rays = 0.f;
  // Light on a receiver in means of the scene. Brighter ones take more rays in proportion: so much
  // larger are their errors. None: all count alike.
  std::function<float(ElementId)> brightness;
  float feature_size = 0.f;  // of shadows in direct light that count; 0: all
  // Where it knows a receiving cluster, a link's weight counts where the cluster is seen from the
  // link's direction, or in the hidden rest when the source lies inside the cluster. Null: on all
  // that faces the direction.
  const ClusterVisibility* inside = nullptr;
};

// The cut of the tree below some elements that receives: clusters of which `as_one(cluster)` holds,
// with directional irradiance, and leaf cells outside them.
template <class AsOne>
std::vector<ElementId> cut_into_receivers(const ElementTree& tree, std::vector<ElementId> below,
                                          const AsOne& as_one) {
  std::vector<ElementId> receivers, open = std::move(below);
  while (!open.empty()) {
    const ElementId e = open.back();
    open.pop_back();
    if (tree[e].is_leaf() ? !tree[e].is_cluster() : tree[e].is_cluster() && as_one(e))
      receivers.push_back(e);
    else
      for (const ElementId child : tree[e].children()) open.push_back(child);
  }
  return receivers;
}

// With the clusters up to their largest diameter (metres).
std::vector<ElementId> choose_receivers(const ElementTree& tree, std::vector<ElementId> below,
                                        const IdVector<ElementId, float>& largest_diameter);

// That a receiver shoots: so many links it gets at most.
int rays_of(const ElementTree& tree, ElementId receiver, const SampledLinkOptions& options);

// A ray stops in a cell in proportion to the cell's opacity, by which radiosity is already reduced:
// the weight is divided by it. In receiver order, each receiver's links in ray order:
// deterministic.
std::vector<ReceiverLink> sample_links(const ElementTree& tree, const RayScene& rays,
                                       const IdVector<ElementId, float>& opacity,
                                       const std::vector<ElementId>& receivers,
                                       const SampledLinkOptions& options);

struct DirectLight {
  std::vector<Arrival> of_emitters;
  std::vector<Arrival> from_outside;  // punctual lights and the sky
};

// Light on a receiving cluster straight from emitters, punctual lights and the sky; shadows by one
// ray from each of some points of the cluster.
DirectLight sample_direct_light(const ElementTree& tree, const Visibility& visibility,
                                const EmitterTree& emitters, ElementId cluster,
                                const SampledLinkOptions& options);

}  // namespace halflight
