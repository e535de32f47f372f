// Pictures to PNG bytes in memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace halflight {

// Texels are rows from the top, sRGB-encoded colour with linear alpha. Empty when it fails.
std::vector<std::uint8_t> encode_png(int width, int height,
                                     std::span<const std::array<std::uint8_t, 4>> texels);

}  // namespace halflight
