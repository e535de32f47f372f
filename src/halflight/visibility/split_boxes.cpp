#include "halflight/visibility/split_boxes.h"

#include <algorithm>
#include <array>

namespace halflight {
namespace {

constexpr int kBins = 16;

struct Bin {
  Bounds3f box;
  float weight = 0.f;

  void add(const Bin& b) {
    box.extend(b.box);
    weight += b.weight;
  }
  float cost() const { return weight > 0.f ? box.surface_area() * weight : 0.f; }
};

int bin_of(const BoxedPart& part, const Bounds3f& centers, int axis) {
  const float share =
      (part.box.center()[axis] - centers.lower[axis]) / centers.extent()[axis] * kBins;
  return std::clamp(static_cast<int>(share), 0, kBins - 1);
}

struct Cut {
  float cost = kInfinity;
  int axis = -1;
  int bin = 0;  // first of the second group
};

// Cheapest of the cuts between bins along one axis.
Cut cheapest_cut(std::span<const BoxedPart> parts, const Bounds3f& centers, int axis) {
  std::array<Bin, kBins> bins;
  for (const BoxedPart& part : parts) {
    Bin& bin = bins[bin_of(part, centers, axis)];
    bin.box.extend(part.box);
    bin.weight += static_cast<float>(part.weight);
  }
  std::array<float, kBins> cost_above{};
  Bin above;
  for (int i = kBins - 1; i > 0; --i) {
    above.add(bins[i]);
    cost_above[i] = above.cost();
  }
  Cut best;
  Bin below;
  for (int i = 1; i < kBins; ++i) {
    below.add(bins[i - 1]);
    const float cost = below.cost() + cost_above[i];
    if (below.weight > 0.f && cost_above[i] > 0.f && cost < best.cost) best = {cost, axis, i};
  }
  return best;
}

}  // namespace

Bounds3f box_of(std::span<const BoxedPart> parts) {
  Bounds3f box;
  for (const BoxedPart& part : parts) box.extend(part.box);
  return box;
}

std::size_t split_boxes(std::span<BoxedPart> parts, bool heuristic) {
  Bounds3f centers;
  for (const BoxedPart& part : parts) centers.extend(part.box.center());
  Cut best;
  for (int axis = 0; heuristic && axis < 3; ++axis) {
    if (!(centers.extent()[axis] > 0.f)) continue;
    const Cut cut = cheapest_cut(parts, centers, axis);
    if (cut.cost < best.cost) best = cut;
  }
  if (best.axis >= 0) {
    const auto middle = std::partition(parts.begin(), parts.end(), [&](const BoxedPart& part) {
      return bin_of(part, centers, best.axis) < best.bin;
    });
    const auto size = static_cast<std::size_t>(middle - parts.begin());
    if (size > 0 && size < parts.size()) return size;
  }
  const int axis = centers.longest_axis();
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::nth_element(parts.begin(), middle, parts.end(), [&](const auto& a, const auto& b) {
    return a.box.center()[axis] < b.box.center()[axis];
  });
  return parts.size() / 2;
}

std::vector<std::size_t> split_boxes_into(std::span<BoxedPart> parts, std::size_t most,
                                          std::uint32_t small_weight, bool heuristic) {
  struct Group {
    std::size_t first, last;
    float area;
    bool whole;
  };
  const auto make_group = [&](std::size_t first, std::size_t last) {
    const auto members = parts.subspan(first, last - first);
    std::uint64_t weight = 0;
    for (const BoxedPart& part : members) weight += part.weight;
    return Group{first, last, box_of(members).surface_area(),
                 members.size() <= 1 || weight <= small_weight};
  };
  std::vector<Group> groups{make_group(0, parts.size())};
  while (groups.size() < most) {
    const auto largest =
        std::max_element(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
          return (a.whole ? -1.f : a.area) < (b.whole ? -1.f : b.area);
        });
    if (largest->whole) break;
    const auto [first, last, area, whole] = *largest;
    const std::size_t size = split_boxes(parts.subspan(first, last - first), heuristic);
    *largest = make_group(first, first + size);
    groups.insert(largest + 1, make_group(first + size, last));
  }
  std::vector<std::size_t> begins;
  for (const Group& group : groups) begins.push_back(group.first);
  begins.push_back(parts.size());
  return begins;
}

}  // namespace halflight
