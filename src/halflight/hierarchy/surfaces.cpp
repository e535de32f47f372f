#include "halflight/hierarchy/surfaces.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "halflight/base/parallel.h"
#include "halflight/hierarchy/half_edges.h"
#include "halflight/hierarchy/morton.h"
#include "halflight/hierarchy/morton_order.h"

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
  for (std::size_t i = s.first_triangle; i < surfaces.triangles.size(); ++i) {
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

void measure(const Geometry& g, const Surfaces& surfaces, Surface& s) {
  s.uv_lower = Vec2(kInfinity);
  s.uv_upper = Vec2(-kInfinity);
  for (std::size_t i = s.first_triangle; i < surfaces.triangles.size(); ++i)
    for (const Vec3& p : g.corners(surfaces.triangles[i])) {
      s.box.extend(p);
      s.uv_lower = glm::min(s.uv_lower, s.to_plane(p));
      s.uv_upper = glm::max(s.uv_upper, s.to_plane(p));
    }
}

// Renumbers surfaces, and their triangles with them.
void order_along_curve(const Geometry& g, Surfaces& surfaces) {
  const std::size_t n = surfaces.surfaces.size();
  std::vector<std::uint64_t> codes(n);
  parallel_for(n, 4096, [&](std::size_t i) {
    codes[i] = morton_code(surfaces[SurfaceId(i)].box.center(), g.bounds);
  });
  Surfaces ordered;
  ordered.surfaces.reserve(n);
  ordered.triangles.reserve(surfaces.triangles.size());
  ordered.cumulative_area.reserve(surfaces.triangles.size());
  for (const std::uint32_t i : order_by_key(codes)) {
    Surface s = surfaces[SurfaceId(i)];
    const std::size_t first = s.first_triangle;
    s.first_triangle = static_cast<std::uint32_t>(ordered.triangles.size());
    const SurfaceId id = ordered.surfaces.push_back(s);
    for (std::size_t k = first; k < first + s.triangle_count; ++k) {
      ordered.triangles.push_back(surfaces.triangles[k]);
      ordered.cumulative_area.push_back(surfaces.cumulative_area[k]);
      surfaces.of_triangle[surfaces.triangles[k]] = id;
    }
  }
  surfaces.surfaces = std::move(ordered.surfaces);
  surfaces.triangles = std::move(ordered.triangles);
  surfaces.cumulative_area = std::move(ordered.cumulative_area);
}

}  // namespace

Surfaces build_surfaces(const Geometry& g) {
  const std::size_t n = g.triangles.size();
  const IdVector<VertexId, VertexId> welded = weld_positions(g);
  const std::vector<HalfEdge> edges = sorted_half_edges(g, welded);
  const auto neighbours = manifold_neighbours(edges, n);

  std::vector<float> area(n);
  parallel_for(n, 4096, [&](std::size_t i) { area[i] = g.area(TriangleId(i)); });
  std::vector<std::uint32_t> largest_first(n);
  std::iota(largest_first.begin(), largest_first.end(), 0u);
  parallel_sort(largest_first, [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(area[b], a) < std::tie(area[a], b);
  });

  Surfaces result;
  result.bodies = find_bodies(g, welded, edges);
  result.of_triangle.resize(n);
  result.triangles.reserve(n);
  result.cumulative_area.reserve(n);
  for (const std::uint32_t seed : largest_first) {
    if (result.of_triangle[TriangleId(seed)].valid()) continue;
    const SurfaceId id(result.surfaces.size());
    Surface s = plane_of(g, TriangleId(seed));
    s.first_triangle = static_cast<std::uint32_t>(result.triangles.size());
    const float tolerance = kSamePlane * std::sqrt(area[seed]);

    result.triangles.push_back(TriangleId(seed));
    result.of_triangle[TriangleId(seed)] = id;
    for (std::size_t next = s.first_triangle; next < result.triangles.size(); ++next) {
      const TriangleId t = result.triangles[next];
      s.area += area[t.value];
      result.cumulative_area.push_back(s.area);
      for (const TriangleId other : neighbours[t.value]) {
        if (!other.valid() || result.of_triangle[other].valid()) continue;
        if (!lies_in(g, other, s, tolerance)) continue;
        result.of_triangle[other] = id;
        result.triangles.push_back(other);
      }
    }
    s.triangle_count = static_cast<std::uint32_t>(result.triangles.size()) - s.first_triangle;
    if (s.triangle_count > 1) align_with_border(g, result, neighbours, s);
    measure(g, result, s);
    result.surfaces.push_back(s);
  }
  order_along_curve(g, result);
  return result;
}

}  // namespace halflight
