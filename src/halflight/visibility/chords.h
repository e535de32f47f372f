// Lines through a box.
#pragma once

#include <cstdint>

#include "halflight/visibility/criterion.h"

namespace halflight {

// Number i of uniform random lines through the box, from one side to another; unit direction.
VisibilityRay random_chord(const Bounds3f& box, std::uint64_t seed, std::uint32_t i);

}  // namespace halflight
