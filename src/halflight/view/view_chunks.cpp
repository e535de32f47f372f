#include "halflight/view/view_chunks.h"

#include <algorithm>
#include <cmath>

#include "halflight/base/morton_order.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

// Each chunk may be a draw call of its own, so there are no more than a few hundred full ones.
constexpr std::size_t kChunkTriangles = 1024, kFullChunks = 512;
constexpr std::size_t kGrain = 4096;

struct Facet {
  Vec3 normal{0.f};  // unit; 0: a triangle without area
  float area = 0.f;
  Vec3 middle{0.f};
};

std::vector<Facet> facets_of(std::span<const Vec3> positions,
                             std::span<const ViewTriangle> triangles) {
  std::vector<Facet> facets(triangles.size());
  parallel_for(facets.size(), kGrain, [&](std::size_t i) {
    const ViewTriangle& t = triangles[i];
    const Vec3 a = positions[t[0]], b = positions[t[1]], c = positions[t[2]];
    const Vec3 normal = glm::cross(b - a, c - a);
    const float length = glm::length(normal);
    if (length > 0.f) facets[i].normal = normal / length;
    facets[i].area = 0.5f * length;
    facets[i].middle = (a + b + c) / 3.f;
  });
  return facets;
}

// The side of a cube that a normal points to.
std::uint32_t side_of_cube(const Vec3& n) {
  const Vec3 size = glm::abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return static_cast<std::uint32_t>(2 * axis + (n[axis] < 0.f ? 1 : 0));
}

// By the way they face, then along the Morton curve; draws stay where they are.
std::vector<std::uint32_t> order_by_place(const std::vector<Facet>& facets,
                                          std::span<const std::uint32_t> sizes) {
  Bounds3f bounds;
  for (const Facet& f : facets) bounds.extend(f.middle);
  std::vector<std::uint64_t> keys(facets.size());
  parallel_for(keys.size(), kGrain, [&](std::size_t i) {
    keys[i] = std::uint64_t{side_of_cube(facets[i].normal)} << 61 |
              morton_code(facets[i].middle, bounds) >> 2;
  });
  std::vector<std::uint32_t> draw_of, next;
  draw_of.reserve(facets.size());
  for (const std::uint32_t size : sizes) {
    next.push_back(static_cast<std::uint32_t>(draw_of.size()));
    draw_of.insert(draw_of.end(), size, static_cast<std::uint32_t>(next.size() - 1));
  }
  std::vector<std::uint32_t> order(facets.size());
  for (const std::uint32_t i : order_by_key(keys)) order[next[draw_of[i]]++] = i;
  return order;
}

// Equal parts of what faces the same way.
std::vector<ViewChunk> cut(const std::vector<Facet>& facets,
                           const std::vector<std::uint32_t>& order,
                           std::span<const std::uint32_t> sizes) {
  const std::size_t most = std::max(kChunkTriangles, order.size() / kFullChunks);
  std::vector<ViewChunk> chunks;
  std::size_t first = 0;
  for (std::uint32_t d = 0; d < sizes.size(); ++d) {
    const std::size_t end = first + sizes[d];
    while (first < end) {
      const std::uint32_t side = side_of_cube(facets[order[first]].normal);
      std::size_t last = first;
      while (last < end && side_of_cube(facets[order[last]].normal) == side) ++last;
      const std::size_t parts = (last - first + most - 1) / most;
      for (std::size_t p = 0; p < parts; ++p) {
        const std::size_t from = first + p * (last - first) / parts;
        const std::size_t to = first + (p + 1) * (last - first) / parts;
        ViewChunk& chunk = chunks.emplace_back();
        chunk.draw = d;
        chunk.first = static_cast<std::uint32_t>(from);
        chunk.count = static_cast<std::uint32_t>(to - from);
      }
      first = last;
    }
  }
  return chunks;
}

void find_cone(ViewChunk& chunk, const std::vector<Facet>& facets,
               std::span<const std::uint32_t> members) {
  Vec3 sum(0.f);
  for (const std::uint32_t i : members) sum += facets[i].normal;
  const float length = glm::length(sum);
  if (!(length > 0.f)) return;
  chunk.axis = sum / length;
  float cosine = 1.f;
  for (const std::uint32_t i : members)
    if (facets[i].area > 0.f) cosine = std::min(cosine, glm::dot(facets[i].normal, chunk.axis));
  if (cosine > 0.f) chunk.sine = std::sqrt(1.f - std::min(1.f, cosine * cosine));
}

}  // namespace

ArrangedTriangles arrange_in_chunks(std::span<const Vec3> positions,
                                    std::span<const ViewTriangle> triangles,
                                    std::span<const std::uint32_t> sizes) {
  const std::vector<Facet> facets = facets_of(positions, triangles);
  ArrangedTriangles arranged;
  arranged.order = order_by_place(facets, sizes);
  arranged.chunks = cut(facets, arranged.order, sizes);
  parallel_for(arranged.chunks.size(), 1, [&](std::size_t c) {
    ViewChunk& chunk = arranged.chunks[c];
    const auto members = std::span(arranged.order).subspan(chunk.first, chunk.count);
    std::stable_sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      return facets[a].area > facets[b].area;
    });
    for (const std::uint32_t i : members)
      for (const std::uint32_t v : triangles[i]) chunk.box.extend(positions[v]);
    find_cone(chunk, facets, members);
  });
  return arranged;
}

void refit(std::span<ViewChunk> chunks, std::span<const Vec3> positions,
           std::span<const ViewTriangle> triangles) {
  parallel_for(chunks.size(), 1, [&](std::size_t c) {
    ViewChunk& chunk = chunks[c];
    chunk.box = {};
    for (const ViewTriangle& t : triangles.subspan(chunk.first, chunk.count))
      for (const std::uint32_t v : t) chunk.box.extend(positions[v]);
  });
}

}  // namespace halflight
