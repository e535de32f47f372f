// Sorting along the Morton curve.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "halflight/base/morton.h"
#include "halflight/base/parallel.h"

namespace halflight {

// Indices in the order of their keys; equal keys keep the order of their indices. Least significant
// digits first, and digits that all keys share cost one look: linear in the number of keys.
std::vector<std::uint32_t> order_by_key(std::span<const std::uint64_t> keys);

// Indices of n things in the order of their centres along the curve; center_of(index).
template <class CenterOf>
std::vector<std::uint32_t> order_along_curve(std::size_t n, const Bounds3f& within,
                                             const CenterOf& center_of) {
  std::vector<std::uint64_t> codes(n);
  parallel_for(n, 4096, [&](std::size_t i) { codes[i] = morton_code(center_of(i), within); });
  return order_by_key(codes);
}

// Puts items into such an order.
template <class T>
void arrange(std::vector<T>& items, std::span<const std::uint32_t> order) {
  std::vector<T> arranged(items.size());
  parallel_for(items.size(), 4096, [&](std::size_t i) { arranged[i] = items[order[i]]; });
  items = std::move(arranged);
}

}  // namespace halflight
