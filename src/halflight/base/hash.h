// Hashes as random numbers: the same integers give the same bits everywhere, with no state.
#pragma once

#include <cstdint>

namespace halflight {

// Mixes integers to 64 well-spread bits (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15ull;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}
template <class... Rest>
constexpr std::uint64_t hash(std::uint64_t first, Rest... rest) {
  std::uint64_t h = mix_bits(first);
  ((h = mix_bits(h ^ static_cast<std::uint64_t>(rest))), ...);
  return h;
}

// Uniform in [0, 1) from the upper bits of a hash.
constexpr float to_unit_float(std::uint64_t h) { return static_cast<float>(h >> 40) * 0x1p-24f; }

}  // namespace halflight
