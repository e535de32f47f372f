// A link says: of the source's radiosity B_s, weight * B_s arrives as irradiance at the receiver.
#pragma once

#include <cstdint>
#include <span>
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
  float error = 0.f;          // of the weight, estimated; for unsampled links its upper bound
  PackedDirection direction;  // from the receiver to the source; used by receiving clusters
  bool sampled() const { return weight >= 0.f; }
  static constexpr float kUnsampled = -1.f;  // weight of a link whose source was dark so far
};

struct ReceiverLink {
  ElementId receiver;
  Link link;
};

// All links, grouped by receiver.
class LinkTable {
 public:
  LinkTable() = default;
  LinkTable(std::size_t element_count, const std::vector<ReceiverLink>& links);

  std::size_t size() const { return links_.size(); }
  std::span<const Link> of(ElementId receiver) const {
    if (receiver.value + 1 >= first_.size()) return {};
    return {links_.data() + first_[receiver.value],
            first_[receiver.value + 1] - first_[receiver.value]};
  }
  // Back to a plain list, in receiver order; leaves the table empty.
  std::vector<ReceiverLink> release();

 private:
  std::vector<std::uint64_t> first_;
  std::vector<Link> links_;
};

}  // namespace halflight
