// A picture of linear RGB floats.
#pragma once

#include <cstddef>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  // row by row, from the top left

  Image() = default;
  Image(int w, int h, const Rgb& fill = Rgb(0.f))
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * h, fill) {}

  Rgb& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const Rgb& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

// Transfer function of sRGB (IEC 61966-2-1), both ways, for one channel in [0, 1].
inline float srgb_from_linear(float c) {
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.f / 2.4f) - 0.055f;
}
inline float linear_from_srgb(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

}  // namespace halflight
