// Cuts polygons of any shape into triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight {

// Appends corners.size() - 2 triangles, as indices into `corners`, wound like the polygon. The
// polygon may be concave and may touch itself (a bridge to a hole); it is seen along its mean
// normal (Newell), so slightly bent ones work too. One that crosses itself or has no area still
// gives that many triangles, some of them degenerate or overlapping.
void triangulate_polygon(std::span<const Vec3> corners,
                         std::vector<std::array<std::uint32_t, 3>>& triangles);

// What that takes, as the square of the number of corners; 0 where the time is about linear.
std::size_t cutting_effort(std::size_t corners);

}  // namespace halflight
