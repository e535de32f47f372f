// Pictures that the tests of the features room share.
#pragma once

#include <cstdint>

#include "halflight/base/image.h"
#include "halflight/features/binary_image.h"
#include "halflight/rays/sampling.h"

namespace halflight::test {

// Uniform in [0, 1) from a seed and a place.
inline float noise(std::uint64_t seed, int x, int y) {
  return to_unit_float(hash(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
}

// Overlapping random rectangles: regions of many widths, borders and all.
inline BinaryImage random_rectangles(int width, int height, int count, std::uint64_t seed) {
  BinaryImage image(width, height);
  const auto pick = [&](int which, int rectangle, int limit) {
    return static_cast<int>(noise(seed, which, rectangle) * static_cast<float>(limit));
  };
  for (int i = 0; i < count; ++i) {
    const int left = pick(0, i, width), top = pick(1, i, height);
    const int right = std::min(width, left + 1 + pick(2, i, width / 3));
    const int bottom = std::min(height, top + 1 + pick(3, i, height / 3));
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) image.set(x, y);
  }
  return image;
}

inline BinaryImage random_bits(int width, int height, float density, std::uint64_t seed) {
  BinaryImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.set(x, y, noise(seed, x, y) < density);
  return image;
}

inline BinaryImage filled_rectangle(int width, int height, int left, int top, int w, int h) {
  BinaryImage image(width, height);
  for (int y = top; y < top + h; ++y)
    for (int x = left; x < left + w; ++x) image.set(x, y);
  return image;
}

inline Image random_image(int width, int height, std::uint64_t seed) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = Rgb(noise(seed, x, y), noise(seed + 1, x, y), noise(seed + 2, x, y));
  return image;
}

}  // namespace halflight::test
