#include "halflight/features/regions.h"

#include <algorithm>
#include <numeric>

namespace halflight {
namespace {

// Union-find over provisional labels; the smaller label is the root, so roots keep raster order.
class Merging {
 public:
  std::uint32_t fresh() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  std::uint32_t root(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  std::uint32_t merge(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_{0};  // 0 stands for clear
};

void extend(Region& r, int x, int y) {
  if (r.pixels++ == 0) {
    r.left = x, r.top = y, r.width = r.height = 1;
    return;
  }
  const int right = std::max(r.left + r.width, x + 1);
  r.left = std::min(r.left, x);
  r.width = right - r.left;
  r.height = y + 1 - r.top;
}

}  // namespace

Regions connected_regions(const BinaryImage& image, Connectivity connectivity) {
  const int width = image.width();
  Regions result;
  result.label.assign(image.pixel_count(), 0);
  Merging merging;
  const auto label_at = [&](int x, int y) -> std::uint32_t {
    if (x < 0 || y < 0 || x >= width) return 0;
    return result.label[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < width; ++x) {
      if (!image.at(x, y)) continue;
      const bool diagonal = connectivity == Connectivity::eight;
      std::uint32_t label = 0;
      for (const std::uint32_t seen :
           {label_at(x - 1, y), label_at(x, y - 1), diagonal ? label_at(x - 1, y - 1) : 0u,
            diagonal ? label_at(x + 1, y - 1) : 0u})
        if (seen != 0) label = label == 0 ? merging.root(seen) : merging.merge(label, seen);
      result.label[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)] = label == 0 ? merging.fresh() : label;
    }

  std::vector<std::uint32_t> final_label;  // of a root
  for (std::size_t i = 0; i < result.label.size(); ++i) {
    if (result.label[i] == 0) continue;
    const std::uint32_t root = merging.root(result.label[i]);
    if (root >= final_label.size()) final_label.resize(root + 1, 0);
    if (final_label[root] == 0) {
      result.regions.emplace_back();
      final_label[root] = static_cast<std::uint32_t>(result.regions.size());
    }
    result.label[i] = final_label[root];
    const auto w = static_cast<std::size_t>(width);
    extend(result.regions[result.label[i] - 1], static_cast<int>(i % w), static_cast<int>(i / w));
  }
  return result;
}

}  // namespace halflight
