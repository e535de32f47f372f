#include "halflight/hierarchy/bodies.h"

#include <algorithm>
#include <numeric>

namespace halflight {

Bodies find_bodies(const Geometry& g, const IdVector<VertexId, VertexId>& welded,
                   const std::vector<HalfEdge>& sorted_half_edges) {
  std::vector<std::uint32_t> parent(g.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& v : g.triangles.raw())
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = find(welded[v[k]].value), b = find(welded[v[(k + 1) % 3]].value);
      parent[std::max(a, b)] = std::min(a, b);
    }

  Bodies bodies;
  bodies.of_triangle.resize(g.triangles.size());
  std::vector<BodyId> numbered(g.positions.size());
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t) {
    BodyId& body = numbered[find(welded[g.triangles[TriangleId(t)][0]].value)];
    if (!body.valid()) body = bodies.members.push_back({});
    bodies.of_triangle[TriangleId(t)] = body;
    bodies.members[body].push_back(TriangleId(t));
  }
  bodies.closed.resize(bodies.members.size(), 1);
  for (auto e = sorted_half_edges.begin(); e != sorted_half_edges.end();) {
    const HalfEdge& first = *e;
    std::size_t forward = 0, backward = 0;
    for (; e != sorted_half_edges.end() && e->is_beside(first); ++e)
      ++(e->forward ? forward : backward);
    if (forward != 1 || backward != 1)
      bodies.closed[bodies.of_triangle[TriangleId(first.triangle)]] = 0;
  }
  return bodies;
}

}  // namespace halflight
