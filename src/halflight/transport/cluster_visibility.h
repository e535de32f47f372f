// Visibility inside clusters that exchange light as one (paper section 6.1): which share of each
// item is seen from a direction, by item buffers along one direction of each cell. What arrives at
// such a cluster is handed to the items that are seen from where it comes, and what leaves it is
// the light of those that are seen from where it goes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/transport/direction_cells.h"
#include "halflight/transport/spherical_harmonics.h"

namespace halflight {

class ClusterVisibility {
 public:
  struct Item {
    ElementId cell;  // a whole side
    Vec3 normal{0.f};
    float area = 0.f;
  };
  // Sums of area times cosine over the items that face a direction.
  struct FacingArea {
    float all = 0.f;
    float seen = 0.f;  // the cluster's silhouette, but for sides that never see light
  };

  ClusterVisibility() = default;
  // Of those of the elements that are clusters whose items hide each other; in others (nearly) all
  // is seen.
  ClusterVisibility(const ElementTree& tree, const IdVector<ElementId, float>& opacity,
                    std::span<const ElementId> elements);

  // e is one of its clusters.
  bool knows(ElementId e) const {
    return e.value < number_.size() && number_[e.value] < clusters_.size() &&
           clusters_[number_[e.value]] == e;
  }
  std::size_t number(ElementId cluster) const { return number_[cluster.value]; }
  std::span<const ElementId> clusters() const { return clusters_; }
  std::span<const Item> items(ElementId cluster) const {
    const std::uint32_t c = number_[cluster.value];
    return {items_.data() + first_[c], items_.data() + first_[c + 1]};
  }
  // Of item i of the cluster, seen from far away in the directions of a cell: 0 to 1.
  float share(ElementId cluster, std::size_t i, int cell) const {
    const std::size_t item = first_[number_[cluster.value]] + i;
    return static_cast<float>(shares_[item * kDirectionCells + static_cast<std::size_t>(cell)]) *
           (1.f / 255.f);
  }
  // The same of an item by itself.
  float share(ElementId item, int cell) const {
    const std::size_t i = number_[item.value];
    return static_cast<float>(shares_[i * kDirectionCells + static_cast<std::size_t>(cell)]) *
           (1.f / 255.f);
  }
  FacingArea facing_area(ElementId cluster, const Vec3& w) const;
  // By what a mean over all that faces w is multiplied when only the seen items share it, or only
  // the hidden parts.
  float concentration(ElementId cluster, const Vec3& w, bool hidden) const;
  // Radiosity of what is seen from far away in the directions of a cell: the mean by visible
  // projected area of the items' own (by element).
  Rgb seen_radiosity(ElementId cluster, int cell, const IdVector<ElementId, Rgb>& radiosity) const;
  // Largest silhouette over all directions, m2.
  float largest_silhouette(ElementId cluster) const { return silhouette_[number_[cluster.value]]; }

 private:
  static constexpr std::uint32_t kUnknown = 0xffffffffu;

  std::vector<std::uint32_t> number_;  // of clusters and of items, each counted by themselves
  std::vector<ElementId> clusters_;
  std::vector<std::uint32_t> first_;  // into items_; one more than clusters
  std::vector<Item> items_;
  std::vector<std::uint8_t> shares_;  // of items, one for each direction cell; in 255ths
  std::vector<float> silhouette_;
};

// Radiosity that an element shows to another; `inside` may be null.
inline Rgb sent_radiosity(const ElementTree& tree, const ClusterVisibility* inside,
                          const IdVector<ElementId, Rgb>& radiosity, ElementId source,
                          ElementId receiver) {
  if (!inside || !inside->knows(source)) return radiosity[source];
  return inside->seen_radiosity(
      source, direction_cell(tree[receiver].center() - tree[source].center()), radiosity);
}

// Light that arrives at a cluster from one direction.
struct Arrival {
  Vec3 towards_source{0.f};  // unit
  Rgb facing{0.f};           // irradiance of what faces it there and is seen
};

// Irradiance of each item of a known cluster: facing times cosine times its visible share.
std::vector<Rgb> hand_out(const ClusterVisibility& inside, ElementId cluster,
                          std::span<const Arrival> light);
// As a function of the normal alone, for clusters whose inside is not known.
DirectionalIrradiance directional_irradiance(std::span<const Arrival> light);

}  // namespace halflight
