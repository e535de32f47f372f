// Bodies: triangles that hang together by shared corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/hierarchy/half_edges.h"
#include "halflight/scene/geometry.h"

namespace halflight {

using BodyId = Id<struct BodyTag>;

struct Bodies {
  IdVector<TriangleId, BodyId> of_triangle;
  IdVector<BodyId, std::uint8_t> closed;  // every edge joins two triangles, consistently wound
  std::vector<std::uint32_t> first;       // of each body into `triangles`; one more than bodies
  std::vector<TriangleId> triangles;      // grouped by body

  std::size_t size() const { return closed.size(); }
  std::span<const TriangleId> members(BodyId id) const {
    return {triangles.data() + first[id.value], triangles.data() + first[id.value + 1]};
  }
};

// Bodies are numbered by their first triangle.
Bodies find_bodies(const Geometry& geometry, const IdVector<VertexId, VertexId>& welded,
                   const std::vector<HalfEdge>& sorted_half_edges);

}  // namespace halflight
