#include "halflight/output/smooth_irradiance.h"

#include <utility>

namespace halflight {
namespace {

Rgb minmod(const Rgb& a, const Rgb& b) {
  Rgb result(0.f);
  for (int c = 0; c < 3; ++c)
    if (a[c] * b[c] > 0.f) result[c] = std::abs(a[c]) < std::abs(b[c]) ? a[c] : b[c];
  return result;
}

// Area-weighted over the leaves of every cell.
IdVector<ElementId, Rgb> mean_irradiances(const ElementTree& tree,
                                          const IdVector<ElementId, Rgb>& of_leaves) {
  IdVector<ElementId, Rgb> mean(tree.size(), Rgb(0.f));
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (tree[e].is_cluster()) continue;
    if (tree[e].is_leaf()) {
      mean[e] = of_leaves[e];
      continue;
    }
    float area = 0.f;
    for (const ElementId child : tree[e].children()) {
      mean[e] += tree[child].area * mean[child];
      area += tree[child].area;
    }
    mean[e] /= std::max(area, 1e-30f);
  }
  return mean;
}

}  // namespace

SmoothIrradiance::SmoothIrradiance(const ElementTree& tree, IdVector<ElementId, Rgb> of_leaves)
    : tree_(&tree), of_leaves_(std::move(of_leaves)), slopes_(tree.size()) {
  const IdVector<ElementId, Rgb> mean = mean_irradiances(tree, of_leaves_);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId e(i);
    if (tree[e].is_cluster() || tree[e].is_leaf()) continue;
    Slopes slopes = slopes_[e];
    if (tree[e].child_count == 2) {
      const ElementId a(tree[e].first_child), b(tree[e].first_child + 1);
      const Surface& surface = tree.surfaces()[tree[e].side];
      const bool across_u = tree[a].cell_upper.x < tree[e].cell_upper.x;
      const Vec2 between = surface.to_plane(tree[b].center()) - surface.to_plane(tree[a].center());
      const float distance = across_u ? between.x : between.y;
      const Rgb found = (mean[b] - mean[a]) / std::max(distance, 1e-30f);
      Rgb& slope = across_u ? slopes.u : slopes.v;
      slope = slope == Rgb(0.f) ? found : minmod(slope, found);
    }
    for (const ElementId child : tree[e].children()) slopes_[child] = slopes;
  }
}

Rgb SmoothIrradiance::at(ElementId leaf, const Vec3& position) const {
  const Surface& surface = tree_->surfaces()[(*tree_)[leaf].side];
  const Vec2 from_centre = surface.to_plane(position) - surface.to_plane((*tree_)[leaf].center());
  const Slopes& s = slopes_[leaf];
  return glm::max(of_leaves_[leaf] + from_centre.x * s.u + from_centre.y * s.v, Rgb(0.f));
}

}  // namespace halflight
