// A link says: of the source's radiosity B_s, weight * B_s arrives as irradiance at the receiver.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/hierarchy/elements.h"

namespace halflight {

// Unit direction in 32 bits (octahedral; Cigolle et al. 2014); zero stands for "from all around".
class PackedDirection {
 public:
  PackedDirection() = default;
  explicit PackedDirection(const Vec3& unit);
  Vec3 unpack() const;
  bool all_around() const { return bits_ == 0; }

 private:
  std::uint32_t bits_ = 0;
};

struct Link {
  ElementId source;
  float weight = 0.f;         // form factor times visibility; perpendicular to the direction when
                              // the receiver is a cluster
  float error = 0.f;          // of the weight, estimated; for unsampled links its upper bound; 0
                              // when nothing can be refined
  PackedDirection direction;  // from the receiver to the source; used by receiving clusters
  bool sampled() const { return weight >= 0.f; }
  static constexpr float kUnsampled = -1.f;  // weight of a link whose source was dark so far
};

struct ReceiverLink {
  ElementId receiver;
  Link link;
};

// Links grouped by receiver. Grows: each call of append adds whole rows.
class LinkTable {
 public:
  LinkTable() = default;
  // Of links in receiver order, so many for each.
  LinkTable(std::span<const std::uint32_t> counts, std::vector<Link> links);

  std::size_t size() const { return size_; }
  // Links that take memory: those of `size` and those that were forgotten.
  std::size_t stored() const { return links_.size(); }
  // Growing to so many in all will not copy what is there.
  void reserve(std::size_t links) { links_.reserve(links); }
  std::span<const Link> of(ElementId receiver) const {
    if (!rows_.contains(receiver)) return {};
    return {links_.data() + rows_[receiver].first, rows_[receiver].count};
  }
  // All links of a receiver must be in the same call, in any order among those of others.
  void append(const std::vector<ReceiverLink>& links);
  // Forgets a receiver's links; their place is only given back by `release`.
  void clear(ElementId receiver) {
    if (!rows_.contains(receiver)) return;
    size_ -= rows_[receiver].count;
    rows_[receiver].count = 0;
  }
  // Back to a plain list, in receiver order; leaves the table empty.
  std::vector<ReceiverLink> release();

 private:
  struct Row {
    std::uint64_t first : 40 = 0;
    std::uint64_t count : 24 = 0;
  };
  IdVector<ElementId, Row> rows_;
  std::vector<Link> links_;
  std::size_t size_ = 0;  // without those that were forgotten
};

}  // namespace halflight
