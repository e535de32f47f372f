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
  bodies.first.push_back(0);
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t) {
    BodyId& body = numbered[find(welded[g.triangles[TriangleId(t)][0]].value)];
    if (!body.valid()) {
      body = BodyId(bodies.first.size() - 1);
      bodies.first.push_back(0);
    }
    bodies.of_triangle[TriangleId(t)] = body;
    ++bodies.first[body.value + 1];
  }
  std::partial_sum(bodies.first.begin(), bodies.first.end(), bodies.first.begin());
  bodies.triangles.resize(g.triangles.size());
  std::vector<std::uint32_t> next = bodies.first;
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t)
    bodies.triangles[next[bodies.of_triangle[TriangleId(t)].value]++] = TriangleId(t);
  bodies.closed.resize(bodies.first.size() - 1, 1);
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
