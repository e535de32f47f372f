#include "halflight/hierarchy/surfaces.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "halflight/base/morton_order.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/half_edges.h"

namespace halflight {
namespace {

// Triangles within this angle of the first one's plane belong to it (radians), and their corners
// within this share of its size.
constexpr float kSameNormal = 2e-3f;
constexpr float kSamePlane = 1e-4f;

// Neighbours across each edge that exactly two triangles share in opposite directions; else
// invalid.
std::vector<std::array<TriangleId, 3>> manifold_neighbours(const std::vector<HalfEdge>& edges,
                                                           std::size_t triangles) {
  std::vector<std::array<TriangleId, 3>> neighbours(triangles);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[j].is_beside(edges[i])) ++j;
    if (j - i == 2 && edges[i].forward != edges[i + 1].forward) {
      const HalfEdge &a = edges[i], &b = edges[i + 1];
      neighbours[a.triangle][a.edge] = TriangleId(b.triangle);
      neighbours[b.triangle][b.edge] = TriangleId(a.triangle);
    }
    i = j;
  }
  return neighbours;
}

// Frame with axis_u along the longest edge of the triangle.
Surface plane_of(const Geometry& g, TriangleId t) {
  const auto corner = g.corners(t);
  Vec3 longest(0.f);
  for (int k = 0; k < 3; ++k) {
    const Vec3 e = corner[(k + 1) % 3] - corner[k];
    if (glm::dot(e, e) > glm::dot(longest, longest)) longest = e;
  }
  // The longest edge of a rectangle's half is its diagonal: prefer the longer leg of a right angle.
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = corner[(k + 1) % 3] - corner[k], b = corner[(k + 2) % 3] - corner[k];
    if (std::abs(glm::dot(a, b)) < 1e-3f * glm::length(a) * glm::length(b))
      longest = glm::dot(a, a) > glm::dot(b, b) ? a : b;
  }
  Surface s;
  s.origin = corner[0];
  s.normal = glm::normalize(g.scaled_normal(t));
  s.axis_u = glm::normalize(longest);
  s.axis_v = glm::normalize(glm::cross(s.normal, s.axis_u));
  s.material = g.materials[t];
  return s;
}

bool lies_in(const Geometry& g, TriangleId t, const Surface& plane, float tolerance) {
  if (g.materials[t] != plane.material) return false;
  const Vec3 n = g.scaled_normal(t);
  if (glm::length(glm::cross(n, plane.normal)) > kSameNormal * glm::length(n)) return false;
  if (glm::dot(n, plane.normal) < 0.f) return false;
  for (const Vec3& p : g.corners(t))
    if (std::abs(glm::dot(p - plane.origin, plane.normal)) > tolerance) return false;
  return true;
}

// The longest edge of the border is one of a rectangle's sides, whatever diagonals it was cut
// along: the cells of walls stay upright.
void align_with_border(const Geometry& g, const Surfaces& surfaces,
                       const std::vector<std::array<TriangleId, 3>>& neighbours, Surface& s) {
  Vec3 longest(0.f);
  const SurfaceId id = surfaces.of_triangle[surfaces.triangles[s.first_triangle]];
  for (std::size_t i = s.first_triangle; i < s.first_triangle + s.triangle_count; ++i) {
    const TriangleId t = surfaces.triangles[i];
    const auto corner = g.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const TriangleId other = neighbours[t.value][k];
      const Vec3 e = corner[(k + 1) % 3] - corner[k];
      const bool inner = other.valid() && surfaces.of_triangle[other] == id;
      if (!inner && glm::dot(e, e) > glm::dot(longest, longest)) longest = e;
    }
  }
  if (!(glm::dot(longest, longest) > 0.f)) return;
  const Vec3 in_plane = longest - glm::dot(longest, s.normal) * s.normal;
  s.axis_u = glm::normalize(in_plane);
  s.axis_v = glm::normalize(glm::cross(s.normal, s.axis_u));
}

void measure(const Geometry& g, Surfaces& surfaces, Surface& s) {
  s.uv_lower = Vec2(kInfinity);
  s.uv_upper = Vec2(-kInfinity);
  for (std::size_t i = s.first_triangle; i < s.first_triangle + s.triangle_count; ++i) {
    const TriangleId t = surfaces.triangles[i];
    s.area += g.area(t);
    surfaces.cumulative_area[i] = s.area;
    for (const Vec3& p : g.corners(t)) {
      s.box.extend(p);
      s.uv_lower = glm::min(s.uv_lower, s.to_plane(p));
      s.uv_upper = glm::max(s.uv_upper, s.to_plane(p));
    }
  }
}

// Triangles by the surface that they belong to; the first of each gives it its plane.
struct Groups {
  std::vector<TriangleId> triangles;
  std::vector<std::uint32_t> first;  // of each group; one more than groups
  std::size_t size() const { return first.size() - 1; }
};

// Whether a triangle can lie in one surface with one of its neighbours. Both would lie within
// kSameNormal of a third one's plane.
bool may_be_joined(const Geometry& g, TriangleId t, const std::array<TriangleId, 3>& neighbours) {
  const Vec3 n = g.scaled_normal(t);
  return std::any_of(neighbours.begin(), neighbours.end(), [&](TriangleId other) {
    if (!other.valid() || g.materials[other] != g.materials[t]) return false;
    const Vec3 m = g.scaled_normal(other);
    return glm::dot(n, m) > 0.f &&
           glm::length(glm::cross(n, m)) <= 3.f * kSameNormal * glm::length(n) * glm::length(m);
  });
}

// Grows surfaces from the largest triangles; those that nothing can join are left for the end.
Groups group_triangles(const Geometry& g,
                       const std::vector<std::array<TriangleId, 3>>& neighbours) {
  const std::size_t n = g.triangles.size();
  std::vector<std::uint8_t> joinable(n);
  parallel_for(n, 4096, [&](std::size_t i) {
    joinable[i] = may_be_joined(g, TriangleId(i), neighbours[i]);
  });
  struct Seed {
    float area;
    std::uint32_t triangle;
  };
  std::vector<Seed> seeds;
  for (std::uint32_t i = 0; i < n; ++i)
    if (joinable[i]) seeds.push_back({g.area(TriangleId(i)), i});
  parallel_sort(seeds, [](const Seed& a, const Seed& b) {
    return std::tie(b.area, a.triangle) < std::tie(a.area, b.triangle);
  });

  Groups groups;
  groups.triangles.reserve(n);
  groups.first.reserve(n + 1);
  std::vector<std::uint8_t> taken(n, 0);
  for (const Seed& seed : seeds) {
    if (taken[seed.triangle]) continue;
    const Surface plane = plane_of(g, TriangleId(seed.triangle));
    const float tolerance = kSamePlane * std::sqrt(seed.area);
    groups.first.push_back(static_cast<std::uint32_t>(groups.triangles.size()));
    groups.triangles.emplace_back(seed.triangle);
    taken[seed.triangle] = 1;
    for (std::size_t next = groups.first.back(); next < groups.triangles.size(); ++next)
      for (const TriangleId other : neighbours[groups.triangles[next].value]) {
        if (!other.valid() || taken[other.value] || !lies_in(g, other, plane, tolerance)) continue;
        taken[other.value] = 1;
        groups.triangles.push_back(other);
      }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    if (taken[i]) continue;
    groups.first.push_back(static_cast<std::uint32_t>(groups.triangles.size()));
    groups.triangles.emplace_back(i);
  }
  groups.first.push_back(static_cast<std::uint32_t>(n));
  return groups;
}

std::vector<std::uint32_t> order_of_groups(const Geometry& g, const Groups& groups) {
  return order_along_curve(groups.size(), g.bounds, [&](std::size_t i) {
    Bounds3f box;
    for (std::size_t k = groups.first[i]; k < groups.first[i + 1]; ++k)
      for (const Vec3& p : g.corners(groups.triangles[k])) box.extend(p);
    return box.center();
  });
}

Surfaces make_surfaces(const Geometry& g, const Groups& groups,
                       const std::vector<std::array<TriangleId, 3>>& neighbours) {
  const std::vector<std::uint32_t> order = order_of_groups(g, groups);
  Surfaces result;
  result.surfaces.resize(groups.size());
  result.triangles.resize(g.triangles.size());
  result.cumulative_area.resize(g.triangles.size());
  result.of_triangle.resize(g.triangles.size());
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    Surface& s = result.surfaces[SurfaceId(i)];
    s.first_triangle = first;
    s.triangle_count = groups.first[order[i] + 1] - groups.first[order[i]];
    first += s.triangle_count;
  }
  const auto for_all = [&](const auto& act) {
    parallel_for(order.size(), 1024, [&](std::size_t i) { act(i, result.surfaces[SurfaceId(i)]); });
  };
  for_all([&](std::size_t i, const Surface& s) {
    for (std::uint32_t k = 0; k < s.triangle_count; ++k) {
      const TriangleId t = groups.triangles[groups.first[order[i]] + k];
      result.triangles[s.first_triangle + k] = t;
      result.of_triangle[t] = SurfaceId(i);
    }
  });
  for_all([&](std::size_t, Surface& s) {
    const std::uint32_t from = s.first_triangle, count = s.triangle_count;
    s = plane_of(g, result.triangles[from]);
    s.first_triangle = from;
    s.triangle_count = count;
    if (count > 1) align_with_border(g, result, neighbours, s);
    measure(g, result, s);
  });
  return result;
}

}  // namespace

Surfaces build_surfaces(const Geometry& g) {
  const IdVector<VertexId, VertexId> welded = weld_positions(g);
  std::vector<HalfEdge> edges = sorted_half_edges(g, welded);
  const auto neighbours = manifold_neighbours(edges, g.triangles.size());
  Bodies bodies = find_bodies(g, welded, edges);
  std::vector<HalfEdge>().swap(edges);
  Surfaces result = make_surfaces(g, group_triangles(g, neighbours), neighbours);
  result.bodies = std::move(bodies);
  return result;
}

}  // namespace halflight
