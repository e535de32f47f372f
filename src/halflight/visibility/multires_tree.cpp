#include "halflight/visibility/multires_tree.h"

#include <algorithm>
#include <cmath>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/visibility/coverage_extinction.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/multires_build.h"
#include "halflight/visibility/wide_ray.h"

namespace halflight {
namespace {

constexpr float kDarkDepth = 6.9f;  // -ln(kBlockedBelow), a little less

}  // namespace

// The one walk behind all queries. The visitor says how far it still wants to look (`reach`) and is
// told of the slots that stop (`stops`) and the blocks to test (`block`); it ends the walk by
// returning false.
template <class Visitor>
void MultiresTree::walk(const VisibilityRay& ray, const StopRule& rule, bool average,
                        Visitor& visit, std::uint32_t root) const {
  if (arrays_.nodes.empty()) return;
  const WideRay& wide = visit.ray;
  const __m256 at_receiver = _mm256_set1_ps(rule.at_receiver);
  const __m256 half_growth = _mm256_set1_ps(0.5f * rule.growth);
  // A box that reaches an end of the ray never stops, whatever the clearance.
  const __m256 clearance =
      _mm256_set1_ps(options_.receiver_clearance / std::max(wide.length, 1e-30f));
  const __m256 end = _mm256_set1_ps(ray.reach);
  const bool by_side = options_.blocker_size == BlockerSizeRule::longest_side;
  const int direction = rows_.empty() ? 0 : nearest_picture_direction(ray.direction);

  std::array<std::uint32_t, kTraversalStack> stack;
  std::size_t stacked = 0;
  stack[stacked++] = root;
  while (stacked > 0) {
    const std::uint32_t index = stack[--stacked];
    const MultiresNode& node = arrays_.nodes[index];
    const Spans spans = meet_slots(node, wide, ray.reach, visit.reach());
    visit.node(spans.met);
    if (spans.met == 0) continue;
    const DirectionalRow* row =
        rows_.empty() ? nullptr : &rows_[kPictureDirections * index + direction];
    const __m256 size =
        by_side ? spans.side
                : decode(arrays_.blocker_code, row ? row->blocker_size : node.blocker_size);
    const __m256 largest = _mm256_add_ps(
        at_receiver, _mm256_mul_ps(half_growth, _mm256_add_ps(spans.near, spans.far)));
    const unsigned clear_of_ends =
        mask_of(_mm256_and_ps(_mm256_cmp_ps(spans.near, _mm256_setzero_ps(), _CMP_GT_OQ),
                              _mm256_cmp_ps(spans.far, end, _CMP_LT_OQ)));
    const unsigned far_off =
        mask_of(_mm256_cmp_ps(_mm256_mul_ps(spans.side, clearance), spans.near, _CMP_LE_OQ));
    const unsigned small = mask_of(_mm256_cmp_ps(size, largest, _CMP_LE_OQ));
    unsigned stopped = small & far_off;
    if (average) stopped |= node.ends;
    stopped &= spans.met & clear_of_ends;
    if (stopped != 0) {
      const __m256 extinction =
          decode(arrays_.extinction_code, row ? row->extinction : node.extinction);
      if (!visit.stops(index, stopped, extinction, spans)) return;
    }
    const unsigned open = spans.met & ~stopped;
    unsigned blocks = open >> node.node_count;
    for (; blocks != 0; blocks &= blocks - 1)
      if (!visit.block(node.first_block + static_cast<unsigned>(__builtin_ctz(blocks)))) return;
    const std::size_t below = stacked;
    for_each_bit(open & ((1u << node.node_count) - 1u), [&](unsigned slot) {
      stack[stacked++] = node.first_node + slot;
      prefetch(arrays_.nodes[node.first_node + slot]);
    });
    if constexpr (Visitor::kNearestFirst) {
      alignas(32) float near[8];
      _mm256_store_ps(near, spans.near);
      std::sort(stack.begin() + below, stack.begin() + stacked,
                [&](std::uint32_t a, std::uint32_t b) {
                  return near[a - node.first_node] > near[b - node.first_node];
                });
    }
  }
}

namespace {

// Adds up what weakens a ray.
struct Weakening {
  static constexpr bool kNearestFirst = false;
  const MultiresNodes& arrays;
  const Scene& scene;
  const Geometry& geometry;
  WideRay ray;
  float far;
  TraversalCount* count;
  float depth = 0.f;          // optical, of the stopped clusters
  float transmittance = 1.f;  // of the surfaces

  float reach() const { return far; }
  void node(unsigned met) const {
    if (!count) return;
    ++count->nodes;
    count->clusters += static_cast<unsigned>(__builtin_popcount(met));
  }
  bool stops(std::uint32_t, unsigned slots, __m256 extinction, const Spans& spans) {
    if (count) count->stops += static_cast<unsigned>(__builtin_popcount(slots));
    const __m256 inside = _mm256_mul_ps(extinction, _mm256_sub_ps(spans.far, spans.near));
    depth += ray.length * sum_of(_mm256_and_ps(inside, lanes_of(slots)));
    return depth < kDarkDepth;
  }
  bool block(std::uint32_t index) {
    if (count) ++count->blocks;
    transmittance *= through_block(scene, geometry, arrays.blocks[index], ray, far);
    return transmittance >= kBlockedBelow;
  }
  float result() const {
    const float both = depth < kDarkDepth ? transmittance * std::exp(-depth) : 0.f;
    return both < kBlockedBelow ? 0.f : both;
  }
};

// Draws where a path ends. Free flights through several media are independent, so the nearest of
// their ends is the end of all.
struct PathEnd {
  static constexpr bool kNearestFirst = true;
  const MultiresNodes& arrays;
  const Scene& scene;
  const Geometry& geometry;
  WideRay ray;
  std::uint64_t seed;
  MediumHit nearest;

  float reach() const { return nearest.distance; }
  static void node(unsigned) {}
  bool stops(std::uint32_t index, unsigned slots, __m256 extinction, const Spans& spans) {
    alignas(32) float kappa[8], near[8], far[8];
    _mm256_store_ps(kappa, extinction);
    _mm256_store_ps(near, spans.near);
    _mm256_store_ps(far, spans.far);
    for_each_bit(slots, [&](unsigned slot) {
      const std::size_t id = kWide * index + slot;
      const float u = to_unit_float(hash(seed, ~id));
      const float distance = near[slot] - std::log1p(-u) / (kappa[slot] * ray.length);
      if (distance >= std::min(far[slot], nearest.distance)) return;
      nearest = {};
      nearest.cluster = arrays.contents[id].cluster;
      nearest.slot = static_cast<std::uint32_t>(id);
      nearest.distance = distance;
    });
    return true;
  }
  bool block(std::uint32_t index) {
    const TriangleBlock& b = arrays.blocks[index];
    const BlockHits hits = meet_block(b, ray, nearest.distance);
    if (hits.met == 0) return true;
    alignas(32) float distance[8], second[8], third[8];
    _mm256_store_ps(distance, hits.distance);
    _mm256_store_ps(second, hits.second);
    _mm256_store_ps(third, hits.third);
    for_each_bit(hits.met, [&](unsigned lane) {
      if (distance[lane] >= nearest.distance) return;
      const TriangleId t = b.triangles[lane];
      const Vec2 barycentric(second[lane], third[lane]);
      // The same choice as RayScene makes.
      if (((b.transparent >> lane) & 1u) != 0 &&
          to_unit_float(hash(seed, t.value)) >= opacity_at(scene, geometry, t, barycentric))
        return;
      nearest.surface.triangle = t;
      nearest.surface.barycentric = barycentric;
      nearest.surface.distance = nearest.distance = distance[lane];
    });
    return true;
  }
};

struct CutRecorder {
  static constexpr bool kNearestFirst = false;
  const MultiresNodes& arrays;
  WideRay ray;
  float far;
  std::vector<std::pair<std::size_t, bool>> slots;  // slot or block, and whether it stopped

  float reach() const { return far; }
  static void node(unsigned) {}
  bool stops(std::uint32_t index, unsigned mask, __m256, const Spans&) {
    for_each_bit(mask, [&](unsigned slot) { slots.emplace_back(kWide * index + slot, true); });
    return true;
  }
  bool block(std::uint32_t index) {
    slots.emplace_back(index, false);
    return true;
  }
};

}  // namespace

MultiresTree::MultiresTree(const Scene& scene, const Geometry& geometry, const Surfaces& surfaces,
                           const ClusterTree& clusters, const MultiresOptions& options)
    : scene_(&scene),
      geometry_(&geometry),
      options_(options),
      arrays_(build_multires_nodes(scene, geometry, surfaces, clusters)) {
  if (options.extinction != ExtinctionRule::area) fit_coverage(scene, geometry, arrays_);
  if (options.blocker_size != BlockerSizeRule::longest_side ||
      options.extinction == ExtinctionRule::directional_coverage)
    take_pictures();
}

std::vector<TriangleId> MultiresTree::contents(std::size_t slot) const {
  const MultiresNodes::Contents& below = arrays_.contents[slot];
  std::vector<TriangleId> triangles;
  for (std::uint32_t b = below.first_block; b < below.last_block; ++b)
    for_each_bit(arrays_.blocks[b].used,
                 [&](unsigned lane) { triangles.push_back(arrays_.blocks[b].triangles[lane]); });
  return triangles;
}

void MultiresTree::take_pictures() {
  const std::size_t slots = kWide * arrays_.nodes.size();
  struct Seen {
    std::array<float, kPictureDirections> size{}, extinction{};
    float isotropic = 0.f;
  };
  std::vector<Seen> seen(slots);
  const bool directional = options_.extinction == ExtinctionRule::directional_coverage;
  parallel_for(slots, 8, [&](std::size_t i) {
    const MultiresNode& node = arrays_.nodes[i / kWide];
    if (i % kWide >= node.slot_count) return;
    const int slot = static_cast<int>(i % kWide);
    const Bounds3f box = node.box_of(slot);
    Seen& s = seen[i];
    s.size.fill(box.longest_side());
    s.extinction.fill(arrays_.extinction_code.decode(node.extinction[slot]));
    s.isotropic = box.longest_side();
    if (box.longest_side() < options_.smallest_picture) return;
    const BlockerSizes sizes = measure_blocker_sizes(*scene_, *geometry_, contents(i), box);
    for (int d = 0; d < kPictureDirections; ++d) {
      s.size[d] = sizes.pictures[d].blocker_size();
      if (directional) s.extinction[d] = sizes.pictures[d].extinction;
    }
    s.isotropic = sizes.isotropic();
  });

  float largest_size = 0.f, largest_extinction = 0.f;
  for (const Seen& s : seen) {
    largest_size = std::max(largest_size, s.isotropic);
    for (const float size : s.size) largest_size = std::max(largest_size, size);
    for (const float k : s.extinction) largest_extinction = std::max(largest_extinction, k);
  }
  arrays_.blocker_code = BlockerCode::for_largest(largest_size);
  const bool by_direction = options_.blocker_size == BlockerSizeRule::directional || directional;
  if (by_direction) {
    arrays_.extinction_code = ExtinctionCode::for_largest(largest_extinction);
    rows_.resize(kPictureDirections * arrays_.nodes.size());
  }
  for (std::size_t i = 0; i < slots; ++i) {
    MultiresNode& node = arrays_.nodes[i / kWide];
    const std::size_t slot = i % kWide;
    if (slot >= node.slot_count) continue;
    node.blocker_size[slot] = arrays_.blocker_code.encode(seen[i].isotropic, true);
    for (int d = 0; by_direction && d < kPictureDirections; ++d) {
      DirectionalRow& row = rows_[kPictureDirections * (i / kWide) + d];
      const bool sized = options_.blocker_size == BlockerSizeRule::directional;
      row.blocker_size[slot] =
          arrays_.blocker_code.encode(sized ? seen[i].size[d] : seen[i].isotropic, true);
      row.extinction[slot] = arrays_.extinction_code.encode(seen[i].extinction[d], false);
    }
  }
}

float MultiresTree::average(const VisibilityRay& ray, const StopRule& rule,
                            TraversalCount* count) const {
  Weakening w{arrays_, *scene_, *geometry_, WideRay(ray), ray.reach, count};
  walk(ray, rule, true, w);
  return w.result();
}

float MultiresTree::multires(const VisibilityRay& ray, const StopRule& rule,
                             TraversalCount* count) const {
  Weakening w{arrays_, *scene_, *geometry_, WideRay(ray), ray.reach, count};
  walk(ray, rule, false, w);
  return w.result();
}

std::optional<MediumHit> MultiresTree::closest_hit(const VisibilityRay& ray, const StopRule& rule,
                                                   std::uint64_t seed) const {
  PathEnd end{arrays_, *scene_, *geometry_, WideRay(ray), seed, {}};
  end.nearest.distance = ray.reach;
  walk(ray, rule, false, end);
  MediumHit& hit = end.nearest;
  if (!hit.in_cluster())
    hit.surface.front =
        glm::dot(geometry_->scaled_normal(hit.surface.triangle), ray.direction) < 0.f;
  else if (hit.distance >= ray.reach)
    return std::nullopt;
  return hit;
}

std::optional<RayHit> MultiresTree::nearest_below(std::uint32_t slot, const VisibilityRay& ray,
                                                  std::uint64_t seed) const {
  PathEnd end{arrays_, *scene_, *geometry_, WideRay(ray), seed, {}};
  end.nearest.distance = ray.reach;
  const MultiresNode& node = arrays_.nodes[slot / kWide];
  const auto i = static_cast<std::uint32_t>(slot % kWide);
  if (i < node.node_count)
    walk(ray, StopRule::never(), false, end, node.first_node + i);
  else
    end.block(node.first_block + i - node.node_count);
  RayHit& hit = end.nearest.surface;
  if (!hit.triangle.valid()) return std::nullopt;
  hit.front = glm::dot(geometry_->scaled_normal(hit.triangle), ray.direction) < 0.f;
  return hit;
}

std::vector<MultiresTree::CutPart> MultiresTree::cut(const VisibilityRay& ray, const StopRule& rule,
                                                     bool average) const {
  CutRecorder recorder{arrays_, WideRay(ray), ray.reach, {}};
  walk(ray, rule, average, recorder);
  std::vector<CutPart> parts;
  for (const auto& [at, stopped] : recorder.slots) {
    CutPart part;
    part.stopped = stopped;
    if (stopped) {
      const MultiresNode& node = arrays_.nodes[at / kWide];
      part.cluster = arrays_.contents[at].cluster;
      part.box = node.box_of(static_cast<int>(at % kWide));
      part.extinction = arrays_.extinction_code.decode(node.extinction[at % kWide]);
      part.triangles = contents(at);
    } else {
      const TriangleBlock& block = arrays_.blocks[at];
      for_each_bit(block.used,
                   [&](unsigned lane) { part.triangles.push_back(block.triangles[lane]); });
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace halflight
