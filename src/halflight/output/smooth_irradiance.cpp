#include "halflight/output/smooth_irradiance.h"

#include <utility>

namespace halflight {
namespace {

// A difference is taken for noise up to so many variances.
constexpr float kCaution = 1.5f;

Rgb minmod(const Rgb& a, const Rgb& b) {
  Rgb result(0.f);
  for (int c = 0; c < 3; ++c)
    if (a[c] * b[c] > 0.f) result[c] = std::abs(a[c]) < std::abs(b[c]) ? a[c] : b[c];
  return result;
}

// Leaves as they are, cells above as the means of their parts by area.
void take_means(const ElementTree& tree, IdVector<ElementId, Rgb>& irradiance,
                IdVector<ElementId, float>& variance) {
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (tree[e].is_cluster() || tree[e].is_leaf()) continue;
    Rgb sum(0.f);
    float squares = 0.f, area = 0.f;
    for (const ElementId child : tree[e].children()) {
      const float a = tree[child].area;
      sum += a * irradiance[child];
      if (!variance.empty()) squares += a * a * variance[child];
      area += a;
    }
    area = std::max(area, 1e-30f);
    irradiance[e] = sum / area;
    if (!variance.empty()) variance[e] = squares / (area * area);
  }
}

// Of a difference, that which its variance does not account for.
float share_of_signal(const Rgb& difference, float variance) {
  const float squared = average(difference) * average(difference);
  const float noise = kCaution * variance;
  return squared > noise ? 1.f - noise / squared : 0.f;
}

}  // namespace

SmoothIrradiance::SmoothIrradiance(const ElementTree& tree, IdVector<ElementId, Rgb> of_leaves,
                                   IdVector<ElementId, float> variance)
    : tree_(&tree), slopes_(tree.size()) {
  take_means(tree, of_leaves, variance);
  of_cells_ = of_leaves;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId e(i);
    if (!tree[e].is_cluster() && !tree[e].is_leaf()) split(e, of_leaves, variance);
  }
}

void SmoothIrradiance::split(ElementId cell, const IdVector<ElementId, Rgb>& means,
                             const IdVector<ElementId, float>& variances) {
  const ElementTree& tree = *tree_;
  const IdRange<ElementId> parts = tree[cell].children();
  for (const ElementId part : parts) {
    slopes_[part] = slopes_[cell];
    of_cells_[part] = of_cells_[cell];
  }
  if (parts.size() != 2) return;
  const ElementId a = parts[0], b = parts[1];
  const Surface& surface = tree.surfaces()[tree[cell].side];
  const bool across_u = tree[a].cell_upper.x < tree[cell].cell_upper.x;
  const Vec2 between = surface.to_plane(tree[b].center()) - surface.to_plane(tree[a].center());
  const float distance = across_u ? between.x : between.y;
  Rgb slope = across_u ? slopes_[cell].u : slopes_[cell].v;

  const Rgb expected = distance * slope, found = means[b] - means[a];
  const float variance = variances.empty() ? 0.f : variances[a] + variances[b];
  const Rgb difference =
      expected + share_of_signal(found - expected, variance) * (found - expected);
  const float share_of_b = tree[b].area / std::max(tree[a].area + tree[b].area, 1e-30f);
  of_cells_[a] -= share_of_b * difference;
  of_cells_[b] += (1.f - share_of_b) * difference;

  const Rgb here = difference / std::max(distance, 1e-30f);
  slope = slope == Rgb(0.f) ? here : minmod(slope, here);
  for (const ElementId part : parts) (across_u ? slopes_[part].u : slopes_[part].v) = slope;
}

Rgb SmoothIrradiance::at(ElementId leaf, const Vec3& position) const {
  const Surface& surface = tree_->surfaces()[(*tree_)[leaf].side];
  const Vec2 from_centre = surface.to_plane(position) - surface.to_plane((*tree_)[leaf].center());
  const Slopes& s = slopes_[leaf];
  return glm::max(of_cells_[leaf] + from_centre.x * s.u + from_centre.y * s.v, Rgb(0.f));
}

}  // namespace halflight
