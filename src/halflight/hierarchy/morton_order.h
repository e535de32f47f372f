// Sorting along the Morton curve.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/hierarchy/morton.h"

namespace halflight {

// Indices in the order of their keys; equal keys keep the order of their indices. Least significant
// digits first, and digits that all keys share cost one look: linear in the number of keys.
std::vector<std::uint32_t> order_by_key(std::span<const std::uint64_t> keys);

}  // namespace halflight
