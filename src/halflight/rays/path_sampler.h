// Sample numbers of one light path: pairs of Owen-scrambled Sobol points, one independent pair of
// dimensions per decision ("padded"), and plain hashed numbers deep in the path.
// Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4); Laine and Karras 2011 for the
// hash.
#pragma once

#include <bit>
#include <cstdint>

#include "halflight/base/vec.h"
#include "halflight/rays/sampling.h"

namespace halflight {

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
  return (v >> 16) | (v << 16);
}

// Owen scrambling of a 32-bit fraction: each bit is flipped by a hash of the bits above it.
constexpr std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed) {
  std::uint32_t v = reverse_bits(fraction);
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return reverse_bits(v);
}

// Second Sobol dimension, times 2^32; the first is reverse_bits(i). Both together are a
// (0,2)-sequence: its generator matrix is Pascal's triangle modulo 2.
constexpr std::uint32_t sobol_second(std::uint32_t i) {
  std::uint32_t result = 0;
  for (std::uint32_t column = 0x80000000u; i != 0; i >>= 1, column ^= column >> 1)
    if (i & 1u) result ^= column;
  return result;
}

// Samples `index` = 0, 1, 2, ... of one seed are well spread over each pair; two seeds are
// independent of each other.
class PathSampler {
 public:
  PathSampler(std::uint64_t seed, std::uint32_t index) : seed_(seed), index_(index) {}

  Vec2 next_pair() {
    const std::uint64_t h = hash(seed_, ++dimension_);
    if (dimension_ > kStratifiedPairs) {
      const std::uint64_t own = hash(h, index_);
      return {to_unit_float(own), to_unit_float(mix_bits(own))};
    }
    const auto low = static_cast<std::uint32_t>(h), high = static_cast<std::uint32_t>(h >> 32);
    // Shuffling the index keeps the pairs independent of one another. Aligned blocks of 2^k samples
    // stay aligned blocks, each of them as well spread.
    const std::uint32_t i = owen_scramble(index_, low ^ 0x9e3779b9u);
    return {to_fraction(owen_scramble(reverse_bits(i), low)),
            to_fraction(owen_scramble(sobol_second(i), high))};
  }
  // For decisions that need bits instead of a number.
  std::uint64_t next_seed() { return hash(seed_, ++dimension_, index_); }

 private:
  static constexpr std::uint32_t kStratifiedPairs = 16;  // about four bounces
  static float to_fraction(std::uint32_t v) { return static_cast<float>(v >> 8) * 0x1p-24f; }

  std::uint64_t seed_;
  std::uint32_t index_;
  std::uint32_t dimension_ = 0;
};

}  // namespace halflight
