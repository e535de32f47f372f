#include "halflight/transport/link.h"

#include <algorithm>

namespace halflight {
namespace {

constexpr float kOctahedralScale = 32766.f;

std::uint32_t quantise(float v) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(v, -1.f, 1.f) * kOctahedralScale) +
                                    32767);
}
float sign_not_zero(float v) { return v >= 0.f ? 1.f : -1.f; }

}  // namespace

PackedDirection::PackedDirection(const Vec3& unit) {
  const float norm = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
  if (!(norm > 0.f)) return;
  Vec2 p = Vec2(unit.x, unit.y) / norm;
  if (unit.z < 0.f)
    p = Vec2((1.f - std::abs(p.y)) * sign_not_zero(p.x),
             (1.f - std::abs(p.x)) * sign_not_zero(p.y));
  bits_ = quantise(p.x) | quantise(p.y) << 16;
}

Vec3 PackedDirection::unpack() const {
  const auto value = [&](int shift) {
    return (static_cast<float>(bits_ >> shift & 0xffffu) - 32767.f) / kOctahedralScale;
  };
  Vec3 v(value(0), value(16), 0.f);
  v.z = 1.f - std::abs(v.x) - std::abs(v.y);
  if (v.z < 0.f) {
    const Vec2 folded((1.f - std::abs(v.y)) * sign_not_zero(v.x),
                      (1.f - std::abs(v.x)) * sign_not_zero(v.y));
    v.x = folded.x;
    v.y = folded.y;
  }
  return glm::normalize(v);
}

LinkTable::LinkTable(std::span<const std::uint32_t> counts, std::vector<Link> links)
    : rows_(counts.size()), links_(std::move(links)), size_(links_.size()) {
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    rows_[ElementId(i)] = {first, counts[i]};
    first += counts[i];
  }
}

void LinkTable::append(const std::vector<ReceiverLink>& links) {
  std::vector<ElementId> receivers;
  for (const ReceiverLink& l : links) {
    if (!rows_.contains(l.receiver)) rows_.resize(l.receiver.value + 1);
    if (rows_[l.receiver].count++ == 0) receivers.push_back(l.receiver);
  }
  std::uint64_t end = links_.size();
  for (const ElementId r : receivers) {
    rows_[r].first = end;
    end += rows_[r].count;
    rows_[r].count = 0;
  }
  links_.resize(end);
  size_ += links.size();
  for (const ReceiverLink& l : links) {
    Row& row = rows_[l.receiver];
    links_[row.first + row.count++] = l.link;
  }
}

std::vector<ReceiverLink> LinkTable::release() {
  std::vector<ReceiverLink> list;
  list.reserve(size_);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    for (const Link& link : of(ElementId(r))) list.push_back({ElementId(r), link});
  *this = {};
  return list;
}

}  // namespace halflight
