#include "halflight/solve/importance.h"

#include <algorithm>
#include <cmath>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/rays/camera_rays.h"

namespace halflight {
namespace {

constexpr int kMostRays = 1 << 16;  // into the picture
constexpr int kBounces = 6;
// Links that have not been sampled, as their source was dark so far, count by a share of their
// upper bound: most of them are hidden.
constexpr float kDarkShare = 0.2f;
// Mean cosine between a direction and the normals of a cluster that face it.
constexpr float kMeanCosine = 0.5f;

}  // namespace

std::vector<RayHit> seen_surfaces(const World& world, const ViewOfInterest& view) {
  const CameraRays camera(view.camera, view.width, view.height);
  const double pixels = static_cast<double>(view.width) * view.height;
  const double step = std::max(1.0, std::sqrt(pixels / kMostRays));
  const auto columns = static_cast<std::size_t>(view.width / step);
  const auto rows = static_cast<std::size_t>(view.height / step);
  return parallel_collect<RayHit>(
      columns * rows, 256, [&](std::size_t i, std::vector<RayHit>& hits) {
        const std::size_t row = i / columns, column = i % columns;
        const Vec2 pixel(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
        const CameraRay ray = camera.through(static_cast<float>(step) * pixel);
        if (const auto hit = world.rays.closest_hit(ray.origin, ray.direction, kInfinity, hash(i)))
          hits.push_back(*hit);
      });
}

IdVector<ElementId, float> solve_importance(const SolverState& state,
                                            const std::vector<RayHit>& seen) {
  const ElementTree& tree = state.tree;
  IdVector<ElementId, float> importance(tree.size(), kLeastImportance);
  // Of a change of the radiosity of each element, on the mean radiosity of the picture.
  IdVector<ElementId, float> direct(tree.size(), 0.f);
  float seen_area = 0.f;
  for (const RayHit& hit : seen) {
    const ElementId leaf = tree.leaf_hit(hit);
    if (!leaf.valid()) continue;
    if (direct[leaf] == 0.f) seen_area += tree[leaf].area;
    direct[leaf] += 1.f / static_cast<float>(seen.size());
  }
  IdVector<ElementId, float> of_radiosity = direct;
  IdVector<ElementId, float> of_irradiance(tree.size(), 0.f);  // summed over the parts
  for (int bounce = 0; bounce < kBounces; ++bounce) {
    for (std::size_t i = tree.size(); i-- > 0;) {
      const ElementId e(i);
      of_irradiance[e] = 0.f;
      if (tree[e].is_leaf_cell())
        of_irradiance[e] = average(state.reflectance[e]) * of_radiosity[e];
      for (const ElementId child : tree[e].children()) of_irradiance[e] += of_irradiance[child];
    }
    of_radiosity = IdVector<ElementId, float>(tree.size(), 0.f);
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const ElementId r(i);
      const float cosine = tree[r].is_cluster() ? kMeanCosine : 1.f;
      for (const Link& l : state.links.of(r))
        of_radiosity[l.source] +=
            cosine * (l.sampled() ? l.weight : kDarkShare * l.error) * of_irradiance[r];
    }
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const ElementId e(i);
      for (const ElementId child : tree[e].children())
        of_radiosity[child] += of_radiosity[e] * tree[child].area / std::max(tree[e].area, 1e-30f);
      if (tree[e].is_leaf()) of_radiosity[e] += direct[e];
    }
  }
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (tree[e].is_leaf_cell()) {
      const float density = average(state.reflectance[e]) * of_radiosity[e] * seen_area /
                            std::max(tree[e].area, 1e-30f);
      importance[e] = direct[e] > 0.f ? 1.f : std::clamp(density, kLeastImportance, 1.f);
    }
    for (const ElementId child : tree[e].children())
      importance[e] = std::max(importance[e], importance[child]);
  }
  return importance;
}

}  // namespace halflight
