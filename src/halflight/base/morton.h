// Morton order of points in a box: 21 bits an axis.
#pragma once

#include <cstdint>

#include "halflight/base/vec.h"

namespace halflight {

inline std::uint64_t spread_bits_by_3(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  v = (v | v << 2) & 0x1249249249249249ull;
  return v;
}

// Coordinates that are no number count as the lower end.
inline std::uint64_t morton_code(const Vec3& p, const Bounds3f& within) {
  const Vec3 extent = glm::max(within.extent(), Vec3(1e-20f));
  const Vec3 share = glm::max(Vec3(0.f), (p - within.lower) / extent);  // in this order
  const Vec3 t = glm::min(share, Vec3(1.f)) * 2097151.f;
  return spread_bits_by_3(static_cast<std::uint64_t>(t.x)) |
         spread_bits_by_3(static_cast<std::uint64_t>(t.y)) << 1 |
         spread_bits_by_3(static_cast<std::uint64_t>(t.z)) << 2;
}

}  // namespace halflight
