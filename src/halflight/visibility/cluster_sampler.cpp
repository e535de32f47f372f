#include "halflight/visibility/cluster_sampler.h"

#include <algorithm>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

// Loose leaves take about three tries, two for what is turned away and the rest for what is hidden;
// a stack of n sheets takes 2 n.
constexpr int kTries = 64;

}  // namespace

ClusterSampler::ClusterSampler(const World& world, const MultiresTree& tree)
    : world_(&world), tree_(&tree) {
  double area = 0.0;
  for (const TriangleBlock& block : tree.arrays().blocks) {
    area_before_.push_back(area);
    for (std::size_t lane = 0; lane < kWide; ++lane)
      if ((block.used >> lane) & 1u)
        area += static_cast<double>(world.geometry.area(block.triangles[lane]));
  }
  area_before_.push_back(area);
}

RayHit ClusterSampler::any_point(std::uint32_t slot, std::uint64_t seed) const {
  const MultiresNodes::Contents& below = tree_->arrays().contents[slot];
  const auto first = area_before_.begin() + below.first_block;
  const auto last = area_before_.begin() + below.last_block;
  const double wanted =
      *first + (*last - *first) * static_cast<double>(to_unit_float(hash(seed, 1)));
  const auto found = std::upper_bound(first + 1, last, wanted) - 1;
  const auto index = std::min<std::size_t>(static_cast<std::size_t>(found - area_before_.begin()),
                                           below.last_block - 1);
  const TriangleBlock& block = tree_->arrays().blocks[index];
  RayHit hit;
  double left = wanted - area_before_[index];
  for (std::size_t lane = 0; lane < kWide && ((block.used >> lane) & 1u); ++lane) {
    hit.triangle = block.triangles[lane];
    left -= static_cast<double>(world_->geometry.area(hit.triangle));
    if (left < 0.0) break;
  }
  hit.barycentric = uniform_triangle(random_shift(hash(seed, 2)));
  return hit;
}

// A point uniform over all area, kept with probability |cos|, is uniform over the projected area;
// those that are not the first on their line are hidden.
std::optional<RayHit> ClusterSampler::visible_point(std::uint32_t slot, const Vec3& direction,
                                                    std::uint64_t seed) const {
  const Geometry& g = world_->geometry;
  const float size = tree_->arrays().box_of(slot).diagonal();
  std::optional<RayHit> seen;
  for (int k = 0; k < kTries; ++k) {
    const std::uint64_t own = hash(seed, slot, k);
    const RayHit tried = any_point(slot, own);
    const Vec3 normal = glm::normalize(g.scaled_normal(tried.triangle));
    if (to_unit_float(hash(own, 3)) >= std::abs(glm::dot(normal, direction))) continue;
    const Vec3 start = g.point(tried.triangle, tried.barycentric) - size * direction;
    const auto first = tree_->nearest_below(slot, {start, direction, 2.f * size}, own);
    if (!first) continue;
    seen = first;
    if (seen->triangle == tried.triangle) break;
  }
  return seen;
}

}  // namespace halflight
