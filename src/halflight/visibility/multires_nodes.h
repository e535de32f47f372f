// The multi-resolution tree as arrays: 8-wide nodes of 128 bytes, triangles in blocks of eight.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Positive numbers as the upper bits of a float: steps of equal ratio, decoded by a shift and an
// addition. 16 bits: 2^64 : 1 in steps of 1/1024 of an octave's start, nearest; 8 bits: 2^32 : 1 in
// eighths, rounded up. What is below the range counts as its lower end.
template <class Code, int kShift>
struct LogCode {
  std::int32_t base = 0;

  static constexpr std::int32_t kLargest = (1 << (8 * sizeof(Code))) - 1;
  static LogCode for_largest(float value) {
    const int bits = std::bit_cast<std::int32_t>(std::max(value, 1e-30f));
    const int octaves = kLargest >> (23 - kShift);
    const int exponent = (bits >> 23) - octaves;
    return {std::max(exponent, 1) << 23};
  }
  Code encode(float value, bool round_up) const {
    const std::int32_t offset =
        std::max(std::bit_cast<std::int32_t>(std::max(value, 0.f)) - base, 0);
    const std::int32_t round = round_up ? (1 << kShift) - 1 : 1 << (kShift - 1);
    return static_cast<Code>(std::min((offset + round) >> kShift, kLargest));
  }
  float decode(Code code) const { return std::bit_cast<float>(base + (code << kShift)); }
};
using ExtinctionCode = LogCode<std::uint16_t, 13>;
using BlockerCode = LogCode<std::uint8_t, 20>;

// Eight children ("slots") at most; those that are nodes come first, then those that are blocks.
// Slot i is node first_node + i, or block first_block + i - node_count.
struct alignas(64) MultiresNode {
  Vec3 origin{0.f};
  Vec3 scale{0.f};                 // metres in one step of `bounds`
  std::uint8_t bounds[6][8]{};     // x lower, x upper, y lower, ...: origin + scale * bound
  std::uint16_t extinction[8]{};   // ExtinctionCode, for the volume of the stored bounds
  std::uint8_t blocker_size[8]{};  // BlockerCode
  std::uint32_t first_node = 0, first_block = 0;
  std::uint8_t node_count = 0, slot_count = 0;
  std::uint8_t ends = 0;  // bit i: slot i holds the surfaces of one cluster; average stops there
  std::uint8_t unused[17]{};

  static std::size_t lower_row(int axis) { return 2 * static_cast<std::size_t>(axis); }
  Bounds3f box_of(int slot) const {
    Bounds3f box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] =
          origin[axis] + scale[axis] * static_cast<float>(bounds[lower_row(axis)][slot]);
      box.upper[axis] =
          origin[axis] + scale[axis] * static_cast<float>(bounds[lower_row(axis) + 1][slot]);
    }
    return box;
  }
};
static_assert(sizeof(MultiresNode) == 128);

struct alignas(32) TriangleBlock {
  float corners[9][8]{};  // x, y, z of the first corner, then of the second and the third
  std::array<TriangleId, 8> triangles;
  std::uint8_t used = 0;         // bit i: lane i holds a triangle
  std::uint8_t transparent = 0;  // bit i: it may let light through
};

// What the slots of a node are as seen along one direction.
struct DirectionalRow {
  std::uint16_t extinction[8]{};
  std::uint8_t blocker_size[8]{};
};

inline constexpr std::size_t kWide = 8;  // slots of a node

struct MultiresNodes {
  std::vector<MultiresNode> nodes;  // 0 is the root; none without triangles
  std::vector<TriangleBlock> blocks;
  // Of each slot (8 * node + slot): the blocks below it, and the deepest cluster that holds them.
  struct Contents {
    std::uint32_t first_block = 0, last_block = 0;
    std::uint32_t cluster = 0;
  };
  std::vector<Contents> contents;
  std::vector<float> blocking_areas;  // of each slot
  ExtinctionCode extinction_code;
  BlockerCode blocker_code;

  bool has(std::size_t slot) const { return slot % kWide < nodes[slot / kWide].slot_count; }
  Bounds3f box_of(std::size_t slot) const {
    return nodes[slot / kWide].box_of(static_cast<int>(slot % kWide));
  }
  float extinction_of(std::size_t slot) const {
    return extinction_code.decode(nodes[slot / kWide].extinction[slot % kWide]);
  }
  // One for each slot, 1/m.
  void store_extinctions(const std::vector<float>& extinctions) {
    extinction_code = ExtinctionCode::for_largest(
        extinctions.empty() ? 0.f : *std::max_element(extinctions.begin(), extinctions.end()));
    for (std::size_t slot = 0; slot < extinctions.size(); ++slot)
      nodes[slot / kWide].extinction[slot % kWide] =
          extinction_code.encode(extinctions[slot], false);
  }
};

}  // namespace halflight
