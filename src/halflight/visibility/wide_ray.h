// Eight boxes or triangles against one ray (AVX2). For sources of this room: programs that use the
// library may be built for other processors.
#pragma once

#include <cmath>

#include <immintrin.h>

#include "halflight/rays/ray_scene.h"
#include "halflight/visibility/criterion.h"
#include "halflight/visibility/multires_nodes.h"

namespace halflight {

// Entries: 7 * (depth of the tree) + 1, and the builder limits the depth to 140.
inline constexpr std::size_t kTraversalStack = 1024;

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

inline __m256 load_bytes(const std::uint8_t* bytes) {
  const __m128i packed = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes));
  return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(packed));
}
inline __m256 decode(const ExtinctionCode& code, const std::uint16_t* packed) {
  const __m128i bits = _mm_loadu_si128(reinterpret_cast<const __m128i*>(packed));
  return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_slli_epi32(_mm256_cvtepu16_epi32(bits), 13),
                                              _mm256_set1_epi32(code.base)));
}
inline __m256 decode(const BlockerCode& code, const std::uint8_t* packed) {
  const __m128i bits = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(packed));
  return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_slli_epi32(_mm256_cvtepu8_epi32(bits), 20),
                                              _mm256_set1_epi32(code.base)));
}
inline unsigned mask_of(__m256 comparison) {
  return static_cast<unsigned>(_mm256_movemask_ps(comparison));
}
inline __m256 lanes_of(unsigned mask) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(mask)), bit);
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit));
}
inline float sum_of(__m256 v) {
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
inline Spans meet_slots(const MultiresNode& node, const WideRay& ray, float reach, float nearest) {
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
inline BlockHits meet_block(const TriangleBlock& block, const WideRay& ray, float reach) {
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

// Product of 1 - opacity over the triangles that a ray meets.
float through_block(const Scene& scene, const Geometry& geometry, const TriangleBlock& block,
                    const WideRay& ray, float reach);

// Both cache lines, before they are wanted.
inline void prefetch(const MultiresNode& node) {
  _mm_prefetch(reinterpret_cast<const char*>(&node), _MM_HINT_T0);
  _mm_prefetch(reinterpret_cast<const char*>(&node) + 64, _MM_HINT_T0);
}

}  // namespace halflight
