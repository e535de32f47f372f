#include "experiments/published_extinction.h"

#include "halflight/visibility/extinction.h"

namespace halflight::experiments {
namespace {

constexpr float kWall = 0.6f;  // of the scene's longest side: surfaces as long are walls

// Length within the box of the way from a to b.
float length_inside(const Bounds3f& box, const Vec3& a, const Vec3& d) {
  float near = 0.f, far = 1.f;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(d[axis]) < 1e-9f) {
      if (a[axis] < box.lower[axis] || a[axis] > box.upper[axis]) return 0.f;
      continue;
    }
    const float t0 = (box.lower[axis] - a[axis]) / d[axis];
    const float t1 = (box.upper[axis] - a[axis]) / d[axis];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return std::max(0.f, far - near) * glm::length(d);
}

}  // namespace

PublishedExtinction::PublishedExtinction(const World& world, const Surfaces& surfaces,
                                         const ClusterTree& tree) {
  const Geometry& g = world.geometry;
  const auto areas = blocking_areas(world.scene, g, surfaces.bodies);
  std::vector<float> blocking(surfaces.surfaces.size(), 0.f);
  for (std::size_t t = 0; t < g.triangles.size(); ++t) {
    const SurfaceId s = surfaces.of_triangle[TriangleId(t)];
    const bool wall = surfaces[s].box.longest_side() > kWall * g.bounds.longest_side();
    if (!wall && !world.scene.materials[surfaces[s].material].emits())
      blocking[s.value] += areas[TriangleId(t)];
  }
  std::vector<std::uint32_t> clusters{tree.root};
  media_.resize(1);
  std::vector<float> own{0.f};
  for (std::size_t m = 0; m < clusters.size(); ++m) {
    const ClusterTree::Cluster& cluster = tree.clusters[clusters[m]];
    for (const SurfaceId s : cluster.surfaces) {
      own[m] += blocking[s.value];
      if (blocking[s.value] > 0.f) media_[m].box.extend(surfaces[s].box);
    }
    media_[m].first_child = static_cast<std::uint32_t>(media_.size());
    media_[m].child_count = static_cast<std::uint32_t>(cluster.clusters.size());
    for (const std::uint32_t child : cluster.clusters) {
      clusters.push_back(child);
      media_.emplace_back();
      own.push_back(0.f);
    }
  }
  for (std::size_t m = media_.size(); m-- > 0;) {
    Medium& medium = media_[m];
    for (std::uint32_t i = 0; i < medium.child_count; ++i)
      medium.box.extend(media_[medium.first_child + i].box);
    if (medium.box.empty()) continue;
    medium.box = thickened(tree.volumes.empty() ? medium.box : tree.volumes[clusters[m]]);
    medium.extinction = extinction(own[m], medium.box);
  }
}

float PublishedExtinction::transmittance(const Vec3& from, const Vec3& to) const {
  const Vec3 d = to - from;
  float depth = 0.f;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Medium& medium = media_[open.back()];
    open.pop_back();
    const float inside = medium.box.empty() ? 0.f : length_inside(medium.box, from, d);
    if (inside <= 0.f) continue;
    depth += medium.extinction * inside;
    for (std::uint32_t i = 0; i < medium.child_count; ++i) open.push_back(medium.first_child + i);
  }
  return std::exp(-depth);
}

}  // namespace halflight::experiments
