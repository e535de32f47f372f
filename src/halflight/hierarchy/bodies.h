// Bodies: triangles that hang together by shared corners.
#pragma once

#include <cstdint>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/hierarchy/half_edges.h"
#include "halflight/scene/geometry.h"

namespace halflight {

using BodyId = Id<struct BodyTag>;

struct Bodies {
  IdVector<TriangleId, BodyId> of_triangle;
  IdVector<BodyId, std::uint8_t> closed;  // every edge joins two triangles, consistently wound
  IdVector<BodyId, std::vector<TriangleId>> members;
};

// Bodies are numbered by their first triangle.
Bodies find_bodies(const Geometry& geometry, const IdVector<VertexId, VertexId>& welded,
                   const std::vector<HalfEdge>& sorted_half_edges);

}  // namespace halflight
