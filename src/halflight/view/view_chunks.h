// Which of the live view's triangles a page may leave out: those out of sight, turned away, or
// small.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight {

using ViewTriangle = std::array<std::uint32_t, 3>;  // vertices

// Neighbours of one draw that face about the same way, the largest first.
struct ViewChunk {
  std::uint32_t draw = 0, first = 0, count = 0;  // triangles
  Bounds3f box;
  Vec3 axis{0.f};    // of a cone that holds all normals
  float sine = 1.f;  // of its half angle; 1: they face any way
};

struct ArrangedTriangles {
  std::vector<std::uint32_t> order;  // in which the triangles are to be drawn
  std::vector<ViewChunk> chunks;     // of the triangles in that order
};

// `sizes` says how many triangles each draw has; draws keep their places.
ArrangedTriangles arrange_in_chunks(std::span<const Vec3> positions,
                                    std::span<const ViewTriangle> triangles,
                                    std::span<const std::uint32_t> sizes);

// After vertices have moved as a whole with their triangles.
void refit(std::span<ViewChunk> chunks, std::span<const Vec3> positions,
           std::span<const ViewTriangle> triangles);

}  // namespace halflight
