#include "halflight/visibility/multires_tree.h"

#include <cmath>

#include <immintrin.h>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/multires_build.h"

namespace halflight {
namespace {

constexpr float kOpaque = 1e-3f;    // as RayScene: a transmittance below this counts as blocked
constexpr float kDarkDepth = 6.9f;  // -ln(kOpaque), a little less
constexpr std::size_t kStackSize = 1024;  // 7 * (depth of the tree) + 1; multires_build.cpp
constexpr std::size_t kWide = 8;

// A ray as eight lanes want it.
struct WideRay {
  float origin[3], direction[3], inverse[3];
  int near_row[3], far_row[3];  // of MultiresNode::bounds
  float length;                 // metres in one unit of the direction

  explicit WideRay(const VisibilityRay& ray) : length(glm::length(ray.direction)) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = ray.receiver[axis];
      direction[axis] = ray.direction[axis];
      // Rays along a side: large instead of infinite, so that no product is undefined.
      const float d = direction[axis];
      inverse[axis] = 1.f / (std::abs(d) < 1e-18f ? std::copysign(1e-18f, d) : d);
      near_row[axis] = 2 * axis + (inverse[axis] < 0.f);
      far_row[axis] = 2 * axis + (inverse[axis] >= 0.f);
    }
  }
};

__m256 load_bytes(const std::uint8_t* bytes) {
  const __m128i packed = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes));
  return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(packed));
}
__m256 decode(const ExtinctionCode& code, const std::uint16_t* packed) {
  const __m128i bits = _mm_loadu_si128(reinterpret_cast<const __m128i*>(packed));
  return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_slli_epi32(_mm256_cvtepu16_epi32(bits), 13),
                                              _mm256_set1_epi32(code.base)));
}
__m256 decode(const BlockerCode& code, const std::uint8_t* packed) {
  const __m128i bits = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(packed));
  return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_slli_epi32(_mm256_cvtepu8_epi32(bits), 20),
                                              _mm256_set1_epi32(code.base)));
}
unsigned mask_of(__m256 comparison) {
  return static_cast<unsigned>(_mm256_movemask_ps(comparison));
}
__m256 lanes_of(unsigned mask) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(mask)), bit);
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit));
}
float sum_of(__m256 v) {
  const __m128 four = _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
  const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
}

// Where the ray is inside the boxes of a node's slots, in units of its direction.
struct Spans {
  __m256 near, far;
  __m256 side;  // longest side of each box, m
  unsigned met;
};

// Slots that begin beyond `nearest` are not met; where the others end does not depend on it, so
// that the same ray stops at the same clusters whatever was found before.
Spans meet_slots(const MultiresNode& node, const WideRay& ray, float reach, float nearest) {
  Spans spans{_mm256_setzero_ps(), _mm256_set1_ps(reach), _mm256_setzero_ps(), 0};
  for (int axis = 0; axis < 3; ++axis) {
    const __m256 low = load_bytes(node.bounds[ray.near_row[axis]]);
    const __m256 high = load_bytes(node.bounds[ray.far_row[axis]]);
    const __m256 scale = _mm256_set1_ps(node.scale[axis] * ray.inverse[axis]);
    const __m256 start = _mm256_set1_ps((node.origin[axis] - ray.origin[axis]) * ray.inverse[axis]);
    spans.near = _mm256_max_ps(spans.near, _mm256_add_ps(start, _mm256_mul_ps(low, scale)));
    spans.far = _mm256_min_ps(spans.far, _mm256_add_ps(start, _mm256_mul_ps(high, scale)));
    const __m256 steps = _mm256_andnot_ps(_mm256_set1_ps(-0.f), _mm256_sub_ps(high, low));
    spans.side = _mm256_max_ps(spans.side, _mm256_mul_ps(steps, _mm256_set1_ps(node.scale[axis])));
  }
  const __m256 crossed = _mm256_cmp_ps(spans.near, spans.far, _CMP_LE_OQ);
  const __m256 wanted = _mm256_cmp_ps(spans.near, _mm256_set1_ps(nearest), _CMP_LE_OQ);
  spans.met = mask_of(_mm256_and_ps(crossed, wanted)) & ((1u << node.slot_count) - 1u);
  return spans;
}

struct BlockHits {
  __m256 distance, second, third;  // barycentric weights of those corners
  unsigned met = 0;
};

// Edges seen from the ray's origin: a ray between two triangles that share an edge meets one of
// them (as Embree's robust mode; Kensler and Shirley 2006).
BlockHits meet_block(const TriangleBlock& block, const WideRay& ray, float reach) {
  struct Wide {
    __m256 x, y, z;
  };
  const auto minus = [](const Wide& a, const Wide& b) {
    return Wide{_mm256_sub_ps(a.x, b.x), _mm256_sub_ps(a.y, b.y), _mm256_sub_ps(a.z, b.z)};
  };
  const auto plus = [](const Wide& a, const Wide& b) {
    return Wide{_mm256_add_ps(a.x, b.x), _mm256_add_ps(a.y, b.y), _mm256_add_ps(a.z, b.z)};
  };
  const auto cross = [](const Wide& a, const Wide& b) {
    return Wide{_mm256_sub_ps(_mm256_mul_ps(a.y, b.z), _mm256_mul_ps(a.z, b.y)),
                _mm256_sub_ps(_mm256_mul_ps(a.z, b.x), _mm256_mul_ps(a.x, b.z)),
                _mm256_sub_ps(_mm256_mul_ps(a.x, b.y), _mm256_mul_ps(a.y, b.x))};
  };
  const auto dot = [](const Wide& a, const Wide& b) {
    return _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(a.x, b.x), _mm256_mul_ps(a.y, b.y)),
                         _mm256_mul_ps(a.z, b.z));
  };
  const auto corner = [&](int k) {
    const auto lane = [&](int axis) {
      return _mm256_sub_ps(_mm256_load_ps(block.corners[3 * k + axis]),
                           _mm256_set1_ps(ray.origin[axis]));
    };
    return Wide{lane(0), lane(1), lane(2)};
  };
  const Wide direction{_mm256_set1_ps(ray.direction[0]), _mm256_set1_ps(ray.direction[1]),
                       _mm256_set1_ps(ray.direction[2])};
  const Wide a = corner(0), b = corner(1), c = corner(2);
  const Wide ac = minus(c, a), ba = minus(a, b), cb = minus(b, c);
  const __m256 u = dot(cross(ac, plus(c, a)), direction);
  const __m256 v = dot(cross(ba, plus(a, b)), direction);
  const __m256 w = dot(cross(cb, plus(b, c)), direction);
  const __m256 all = _mm256_add_ps(_mm256_add_ps(u, v), w);
  const __m256 sign = _mm256_set1_ps(-0.f);
  const __m256 slack = _mm256_mul_ps(_mm256_andnot_ps(sign, all), _mm256_set1_ps(0x1p-23f));
  const __m256 least = _mm256_min_ps(_mm256_min_ps(u, v), w);
  const __m256 most = _mm256_max_ps(_mm256_max_ps(u, v), w);
  const __m256 inside = _mm256_or_ps(_mm256_cmp_ps(least, _mm256_xor_ps(slack, sign), _CMP_GE_OQ),
                                     _mm256_cmp_ps(most, slack, _CMP_LE_OQ));
  BlockHits hits{};
  hits.met = mask_of(inside) & block.used;
  if (hits.met == 0) return hits;
  const Wide normal = cross(ac, ba);
  const __m256 slope = dot(normal, direction);
  hits.distance = _mm256_div_ps(dot(a, normal), slope);
  hits.second = _mm256_div_ps(u, all);
  hits.third = _mm256_div_ps(v, all);
  const __m256 within =
      _mm256_and_ps(_mm256_cmp_ps(hits.distance, _mm256_setzero_ps(), _CMP_GE_OQ),
                    _mm256_cmp_ps(hits.distance, _mm256_set1_ps(reach), _CMP_LE_OQ));
  hits.met &=
      mask_of(_mm256_and_ps(within, _mm256_cmp_ps(slope, _mm256_setzero_ps(), _CMP_NEQ_OQ)));
  return hits;
}

template <class Visit>
void for_each_bit(unsigned mask, const Visit& visit) {
  for (; mask != 0; mask &= mask - 1) visit(static_cast<unsigned>(__builtin_ctz(mask)));
}

}  // namespace

// The one walk behind all queries. The visitor says how far it still wants to look (`reach`) and is
// told of the slots that stop (`stops`) and the blocks to test (`block`); it ends the walk by
// returning false.
template <class Visitor>
void MultiresTree::walk(const VisibilityRay& ray, const StopRule& rule, bool average,
                        Visitor& visit) const {
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

  std::uint32_t stack[kStackSize];
  std::size_t stacked = 0;
  stack[stacked++] = 0;
  while (stacked > 0) {
    const std::uint32_t index = stack[--stacked];
    const MultiresNode& node = arrays_.nodes[index];
    visit.node();
    const Spans spans = meet_slots(node, wide, ray.reach, visit.reach());
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
    for_each_bit(open & ((1u << node.node_count) - 1u),
                 [&](unsigned slot) { stack[stacked++] = node.first_node + slot; });
  }
}

namespace {

// Adds up what weakens a ray.
struct Weakening {
  const MultiresNodes& arrays;
  const Scene& scene;
  const Geometry& geometry;
  WideRay ray;
  float far;
  TraversalCount* count;
  float depth = 0.f;          // optical, of the stopped clusters
  float transmittance = 1.f;  // of the surfaces

  float reach() const { return far; }
  void node() const {
    if (count) ++count->nodes;
  }
  bool stops(std::uint32_t, unsigned slots, __m256 extinction, const Spans& spans) {
    if (count) count->stops += static_cast<unsigned>(__builtin_popcount(slots));
    const __m256 inside = _mm256_mul_ps(extinction, _mm256_sub_ps(spans.far, spans.near));
    depth += ray.length * sum_of(_mm256_and_ps(inside, lanes_of(slots)));
    return depth < kDarkDepth;
  }
  bool block(std::uint32_t index) {
    if (count) ++count->blocks;
    const TriangleBlock& b = arrays.blocks[index];
    const BlockHits hits = meet_block(b, ray, far);
    if ((hits.met & ~b.transparent) != 0) transmittance = 0.f;
    if (transmittance == 0.f || hits.met == 0) return transmittance > 0.f;
    alignas(32) float second[8], third[8];
    _mm256_store_ps(second, hits.second);
    _mm256_store_ps(third, hits.third);
    for_each_bit(hits.met, [&](unsigned lane) {
      transmittance *=
          1.f - opacity_at(scene, geometry, b.triangles[lane], {second[lane], third[lane]});
    });
    return transmittance >= kOpaque;
  }
  float result() const {
    const float both = depth < kDarkDepth ? transmittance * std::exp(-depth) : 0.f;
    return both < kOpaque ? 0.f : both;
  }
};

// Draws where a path ends. Free flights through several media are independent, so the nearest of
// their ends is the end of all.
struct PathEnd {
  const MultiresNodes& arrays;
  const Scene& scene;
  const Geometry& geometry;
  WideRay ray;
  std::uint64_t seed;
  MediumHit nearest;

  float reach() const { return nearest.distance; }
  static void node() {}
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
  const MultiresNodes& arrays;
  WideRay ray;
  float far;
  std::vector<std::pair<std::size_t, bool>> slots;  // slot or block, and whether it stopped

  float reach() const { return far; }
  static void node() {}
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
  if (options.blocker_size != BlockerSizeRule::longest_side || options.coverage_extinction)
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
      if (options_.coverage_extinction) s.extinction[d] = sizes.pictures[d].extinction;
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
  const bool by_direction =
      options_.blocker_size == BlockerSizeRule::directional || options_.coverage_extinction;
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
