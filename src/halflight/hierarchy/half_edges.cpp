#include "halflight/hierarchy/half_edges.h"

#include <algorithm>
#include <tuple>

#include "halflight/base/parallel.h"

namespace halflight {

IdVector<VertexId, VertexId> weld_positions(const Geometry& g) {
  struct Corner {
    Vec3 p;
    VertexId vertex;
  };
  const std::size_t n = g.positions.size();
  std::vector<Corner> corners(n);
  for (std::size_t i = 0; i < n; ++i) corners[i] = {g.positions[VertexId(i)], VertexId(i)};
  parallel_sort(corners, [](const Corner& a, const Corner& b) {
    return std::tie(a.p.x, a.p.y, a.p.z, a.vertex.value) <
           std::tie(b.p.x, b.p.y, b.p.z, b.vertex.value);
  });
  IdVector<VertexId, VertexId> welded(n);
  for (std::size_t i = 0; i < n;) {
    const Corner& first = corners[i];
    for (; i < n && corners[i].p == first.p; ++i) welded[corners[i].vertex] = first.vertex;
  }
  return welded;
}

std::vector<HalfEdge> sorted_half_edges(const Geometry& g,
                                        const IdVector<VertexId, VertexId>& welded) {
  std::vector<HalfEdge> edges(3 * g.triangles.size());
  parallel_for(g.triangles.size(), 4096, [&](std::size_t t) {
    const auto& v = g.triangles[TriangleId(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[v[k]].value, b = welded[v[(k + 1) % 3]].value;
      edges[3 * t + k] = {std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t),
                          static_cast<std::uint8_t>(k), a < b};
    }
  });
  parallel_sort(edges, std::less<>());
  return edges;
}

}  // namespace halflight
