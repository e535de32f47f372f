#include "halflight/visibility/wide_ray.h"

namespace halflight {

float through_block(const Scene& scene, const Geometry& geometry, const TriangleBlock& block,
                    const WideRay& ray, float reach) {
  const BlockHits hits = meet_block(block, ray, reach);
  if (hits.met == 0) return 1.f;
  if ((hits.met & ~block.transparent) != 0) return 0.f;
  alignas(32) float second[8], third[8];
  _mm256_store_ps(second, hits.second);
  _mm256_store_ps(third, hits.third);
  float light = 1.f;
  for_each_bit(hits.met, [&](unsigned lane) {
    light *= 1.f - opacity_at(scene, geometry, block.triangles[lane], {second[lane], third[lane]});
  });
  return light;
}

}  // namespace halflight
