#include "halflight/features/feature_mask.h"

#include <cassert>
#include <cmath>

#include "halflight/base/parallel.h"

namespace halflight {

BinaryImage shadow_of(std::span<const float> visibility, int width, int height) {
  BinaryImage shadow(width, height);
  assert(visibility.size() == shadow.pixel_count());
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t row) {
    const auto seen = visibility.subspan(row * static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x)
      if (!(seen[static_cast<std::size_t>(x)] >= 1.f - kFullView))
        shadow.set(x, static_cast<int>(row));
  });
  return shadow;
}

int erosions_for(double feature_size) {
  return feature_size > 0 ? static_cast<int>(std::lround(feature_size / 2)) : 0;
}

BinaryImage feature_mask(const BinaryImage& shadow, double feature_size,
                         Connectivity connectivity) {
  return opening(shadow, erosions_for(feature_size), connectivity, Outside::ignored);
}

BinaryImage symmetric_feature_mask(const BinaryImage& shadow, double feature_size,
                                   Connectivity connectivity) {
  return unite(feature_mask(shadow, feature_size, connectivity),
               feature_mask(complement(shadow), feature_size, connectivity));
}

}  // namespace halflight
