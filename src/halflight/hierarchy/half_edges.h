// How triangles hang together: corners at the same place, and edges between them.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "halflight/scene/geometry.h"

namespace halflight {

// For every vertex the first vertex at exactly the same position.
IdVector<VertexId, VertexId> weld_positions(const Geometry& geometry);

struct HalfEdge {
  std::uint32_t low, high;  // welded vertices
  std::uint32_t triangle;
  std::uint8_t edge;  // of the triangle: from corner `edge` to the next
  bool forward;       // runs low -> high

  auto operator<=>(const HalfEdge&) const = default;
  bool is_beside(const HalfEdge& o) const { return low == o.low && high == o.high; }
};

// Those of all triangles; the ones that share their two vertices lie side by side.
std::vector<HalfEdge> sorted_half_edges(const Geometry& geometry,
                                        const IdVector<VertexId, VertexId>& welded);

}  // namespace halflight
