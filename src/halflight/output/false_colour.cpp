#include "halflight/output/false_colour.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace halflight {
namespace {

// Nine evenly spaced colours of the map, sRGB bytes; the map is nearly linear between them.
constexpr std::array<std::array<float, 3>, 9> kViridis{{{68, 1, 84},
                                                        {71, 44, 122},
                                                        {59, 81, 139},
                                                        {44, 113, 142},
                                                        {33, 144, 141},
                                                        {39, 173, 129},
                                                        {92, 200, 99},
                                                        {170, 220, 50},
                                                        {253, 231, 37}}};

}  // namespace

Rgb false_colour(float value) {
  const float place = (value > 0.f ? std::min(value, 1.f) : 0.f) * (kViridis.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const float share = place - static_cast<float>(below);
  Rgb colour;
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const float byte = kViridis[below][k] + share * (kViridis[below + 1][k] - kViridis[below][k]);
    colour[c] = linear_from_srgb(byte / 255.f);
  }
  return colour;
}

Image false_colour_image(std::span<const float> values, int width, int height, float full_scale) {
  Image image(width, height);
  assert(values.size() == image.pixels.size() && full_scale > 0.f);
  for (std::size_t i = 0; i < values.size(); ++i)
    image.pixels[i] = false_colour(values[i] / full_scale);
  return image;
}

}  // namespace halflight
