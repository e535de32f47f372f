// Which vertices lie at the same place, and which triangles share an edge there.
#pragma once

#include <span>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/scene/geometry.h"

namespace halflight {

using PointId = Id<struct PointTag>;

struct WeldedPoints {
  IdVector<PointId, Vec3> positions;
  IdVector<VertexId, PointId> of_vertex;  // invalid for vertices that no triangle uses

  std::array<PointId, 3> corners(const Geometry& g, TriangleId t) const {
    const auto& v = g.triangles[t];
    return {of_vertex[v[0]], of_vertex[v[1]], of_vertex[v[2]]};
  }
};

// Two vertices are one point when they are nearer than the rounding error of transformed
// coordinates (4 units in the last place of the scene's largest coordinate).
WeldedPoints weld(const Geometry& geometry);

// Side k of a triangle runs from its corner k to its corner k + 1.
struct TriangleSide {
  PointId far_end;  // the end with the larger id
  TriangleId triangle;
  std::uint8_t side = 0;
  bool upwards = false;  // runs from the smaller id to the larger
};

// The sides of all triangles, those that share an edge next to each other.
class SharedEdges {
 public:
  SharedEdges(const Geometry& geometry, const WeldedPoints& points);

  // Calls visit(span<const TriangleSide>) once for each edge, in a fixed order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t point = 0; point + 1 < first_.size(); ++point) {
      const std::span all(sides_.data() + first_[point], first_[point + 1] - first_[point]);
      for (std::size_t i = 0, j = 0; i < all.size(); i = j) {
        while (j < all.size() && all[j].far_end == all[i].far_end) ++j;
        visit(all.subspan(i, j - i));
      }
    }
  }

 private:
  std::vector<std::uint32_t> first_;  // by the edge's end with the smaller id
  std::vector<TriangleSide> sides_;
};

}  // namespace halflight
