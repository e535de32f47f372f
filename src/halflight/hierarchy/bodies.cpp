#include "halflight/hierarchy/bodies.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace halflight {

Bodies find_bodies(const Geometry& g, const IdVector<VertexId, VertexId>& welded) {
  std::vector<std::uint32_t> parent(g.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<std::tuple<std::uint32_t, std::uint32_t, bool, std::uint32_t>> edges;
  edges.reserve(3 * g.triangles.size());
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t) {
    const auto& v = g.triangles[TriangleId(t)];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[v[k]].value, b = welded[v[(k + 1) % 3]].value;
      parent[std::max(find(a), find(b))] = std::min(find(a), find(b));
      edges.emplace_back(std::min(a, b), std::max(a, b), a < b, t);
    }
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
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    const auto [low, high, first_forward, t] = edges[i];
    std::size_t forward = 0, backward = 0;
    for (; i < edges.size() && std::get<0>(edges[i]) == low && std::get<1>(edges[i]) == high; ++i)
      ++(std::get<2>(edges[i]) ? forward : backward);
    if (forward != 1 || backward != 1) bodies.closed[bodies.of_triangle[TriangleId(t)]] = 0;
  }
  return bodies;
}

}  // namespace halflight
