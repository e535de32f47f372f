// RGB in 32 bits: three mantissas of 9 bits and an exponent of 5 (OpenGL's RGB9_E5). Right to 0.2 %
// of the brightest channel, from 2^-24 to 65408.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "halflight/base/vec.h"

namespace halflight {

inline std::uint32_t pack_rgb9e5(const Rgb& c) {
  constexpr float kLargest = 65408.f;
  const Rgb v = glm::clamp(c, Rgb(0.f), Rgb(kLargest));
  const float most = max_component(v);
  if (!(most > 0x1p-25f)) return 0;
  int exponent = std::max(-16, std::ilogb(most)) + 1;
  if (most * std::ldexp(1.f, 9 - exponent) >= 511.5f) ++exponent;
  const float scale = std::ldexp(1.f, 9 - exponent);
  const auto mantissa = [&](float x) { return static_cast<std::uint32_t>(std::lround(x * scale)); };
  return mantissa(v.r) | mantissa(v.g) << 9 | mantissa(v.b) << 18 |
         static_cast<std::uint32_t>(exponent + 15) << 27;
}

inline Rgb unpack_rgb9e5(std::uint32_t bits) {
  const float scale = std::ldexp(1.f, static_cast<int>(bits >> 27) - 15 - 9);
  return {static_cast<float>(bits & 511u) * scale, static_cast<float>(bits >> 9 & 511u) * scale,
          static_cast<float>(bits >> 18 & 511u) * scale};
}

}  // namespace halflight
