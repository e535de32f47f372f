// Splitting a set of boxes in two by the binned surface area heuristic (Wald 2007, "On fast
// construction of SAH-based bounding volume hierarchies").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight {

struct BoxedPart {
  Bounds3f box;
  std::uint32_t index = 0;
  std::uint32_t weight = 1;  // how much it costs to look into
};

Bounds3f box_of(std::span<const BoxedPart> parts);

// Reorders the parts, the first of the two groups in front, and returns its size: at least 1 and
// less than all. Halves of equal number when the heuristic is not wanted or finds nothing.
std::size_t split_boxes(std::span<BoxedPart> parts, bool heuristic);

// At most `most` groups, by splitting the group with the largest surface again and again. Groups of
// weight up to `small_weight`, and of one part, stay whole. Returns where the groups begin, and the
// number of parts.
std::vector<std::size_t> split_boxes_into(std::span<BoxedPart> parts, std::size_t most,
                                          std::uint32_t small_weight, bool heuristic);

}  // namespace halflight
