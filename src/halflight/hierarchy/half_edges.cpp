#include "halflight/hierarchy/half_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr int kBucketBits = 12;
constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;
constexpr std::size_t kKeysAtOnce = 1 << 17;

// The same for equal positions; 0 and -0 are equal.
std::uint64_t key_of(const Vec3& p) {
  const Vec3 q = p + Vec3(0.f);
  return hash(std::bit_cast<std::uint32_t>(q.x), std::bit_cast<std::uint32_t>(q.y),
              std::bit_cast<std::uint32_t>(q.z));
}

// Indices by the highest bits of their keys.
struct Buckets {
  std::vector<std::uint32_t> first;  // one more than buckets
  std::vector<std::uint32_t> indices;
  std::size_t count() const { return first.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t b) const {
    return {indices.data() + first[b], indices.data() + first[b + 1]};
  }
};

Buckets spread_over_buckets(std::span<const std::uint64_t> keys) {
  const std::size_t blocks = (keys.size() + kKeysAtOnce - 1) / kKeysAtOnce;
  const auto bucket_of = [&](std::size_t i) { return keys[i] >> (64 - kBucketBits); };
  const auto for_block = [&](std::size_t b, const auto& visit) {
    const std::size_t last = std::min(keys.size(), (b + 1) * kKeysAtOnce);
    for (std::size_t i = b * kKeysAtOnce; i < last; ++i) visit(i);
  };
  std::vector<std::array<std::uint32_t, kBuckets>> starts(blocks);
  parallel_for(blocks, 1, [&](std::size_t b) {
    starts[b] = {};
    for_block(b, [&](std::size_t i) { ++starts[b][bucket_of(i)]; });
  });
  Buckets buckets{std::vector<std::uint32_t>(kBuckets + 1),
                  std::vector<std::uint32_t>(keys.size())};
  std::uint32_t end = 0;
  for (std::size_t k = 0; k < kBuckets; ++k) {
    buckets.first[k] = end;
    for (auto& block : starts) end += std::exchange(block[k], end);
  }
  buckets.first[kBuckets] = end;
  parallel_for(blocks, 1, [&](std::size_t b) {
    for_block(b, [&](std::size_t i) {
      buckets.indices[starts[b][bucket_of(i)]++] = static_cast<std::uint32_t>(i);
    });
  });
  return buckets;
}

}  // namespace

// Vertices at the same position come into the same bucket, in each in their own order; then every
// bucket is small enough for a table of its own.
IdVector<VertexId, VertexId> weld_positions(const Geometry& g) {
  const std::size_t n = g.positions.size();
  std::vector<std::uint64_t> keys(n);
  parallel_for(n, 1 << 14, [&](std::size_t i) { keys[i] = key_of(g.positions[VertexId(i)]); });
  const Buckets buckets = spread_over_buckets(keys);
  IdVector<VertexId, VertexId> welded(n);
  parallel_ranges(buckets.count(), 8, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> table;
    for (std::size_t b = first; b < last; ++b) {
      const std::span<const std::uint32_t> members = buckets[b];
      const std::size_t mask = std::bit_ceil(2 * members.size() + 1) - 1;
      table.assign(mask + 1, VertexId::kInvalid);
      for (const std::uint32_t v : members) {
        std::size_t at = keys[v] & mask;
        while (table[at] != VertexId::kInvalid &&
               g.positions[VertexId(table[at])] != g.positions[VertexId(v)])
          at = (at + 1) & mask;
        if (table[at] == VertexId::kInvalid) table[at] = v;
        welded[VertexId(v)] = VertexId(table[at]);
      }
    }
  });
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
