// Deterministic sampling: hashed seeds and low-discrepancy points, no global state.
#pragma once

#include <cstdint>

#include "halflight/base/hash.h"
#include "halflight/base/vec.h"

namespace halflight {

// Point i of an additive sequence of the steps a and b (in units of 2^-32), from `shift`, in
// [0, 1)^2.
inline Vec2 additive_sequence(std::uint32_t i, std::uint32_t a, std::uint32_t b, Vec2 shift) {
  const float x = static_cast<float>((i * a) >> 8) * 0x1p-24f + shift.x;
  const float y = static_cast<float>((i * b) >> 8) * 0x1p-24f + shift.y;
  return {x - std::floor(x), y - std::floor(y)};
}
// The R2 sequence (Roberts 2018): steps 1/p and 1/p^2 of the plastic number. Any prefix is well
// spread.
inline Vec2 r2_sequence(std::uint32_t i, Vec2 shift = Vec2(0.5f)) {
  return additive_sequence(i, 3242174889u, 2447445414u, shift);
}
// To go with r2_sequence where two places are sampled at once: of steps sqrt 2 and sqrt 3, so that
// the pairs fill [0, 1)^4. The same sequence twice would keep the two a constant apart.
inline Vec2 companion_sequence(std::uint32_t i, Vec2 shift = Vec2(0.5f)) {
  return additive_sequence(i, 1779033705u, 3144134279u, shift);
}
// A shift for these sequences from a seed.
inline Vec2 random_shift(std::uint64_t seed) {
  return {to_unit_float(hash(seed, 1)), to_unit_float(hash(seed, 2))};
}

// Barycentric weights (of corners 2 and 3) uniform over a triangle (Heitz 2019, low distortion).
inline Vec2 uniform_triangle(Vec2 u) {
  if (u.y > u.x) {
    const float b = 0.5f * u.x;
    return {b, u.y - b};
  }
  const float b = 0.5f * u.y;
  return {u.x - b, b};
}

// Direction about +Z with density cos(theta) / pi.
inline Vec3 cosine_hemisphere(Vec2 u) {
  const float r = std::sqrt(u.x), phi = 2.f * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1.f - u.x))};
}

// Direction uniform over the sphere.
inline Vec3 uniform_sphere(Vec2 u) {
  const float z = 1.f - 2.f * u.x, r = std::sqrt(std::max(0.f, 1.f - z * z)), phi = 2.f * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace halflight
