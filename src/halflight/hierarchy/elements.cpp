#include "halflight/hierarchy/elements.h"

#include <algorithm>
#include <array>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

float polygon_area(std::span<const Vec2> p) {
  float doubled = 0.f;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vec2 a = p[i] - p[0], b = p[i + 1] - p[0];
    doubled += a.x * b.y - a.y * b.x;
  }
  return 0.5f * std::abs(doubled);
}

// Position of the first entry of an increasing array that exceeds `wanted`.
template <class Array, class Value>
std::size_t pick(const Array& cumulative, std::size_t first, std::size_t count, float wanted,
                 const Value& value) {
  std::size_t low = 0, high = count - 1;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (value(cumulative[first + middle]) > wanted)
      high = middle;
    else
      low = middle + 1;
  }
  return first + low;
}

// Which clusters hold a live side anywhere below.
std::vector<bool> inhabited(const ClusterTree& tree, const IdVector<SideId, std::uint8_t>& live) {
  std::vector<std::uint32_t> parents_first{tree.root};
  for (std::size_t next = 0; next < parents_first.size(); ++next)
    for (const std::uint32_t child : tree.clusters[parents_first[next]].clusters)
      parents_first.push_back(child);
  std::vector<bool> result(tree.clusters.size(), false);
  for (std::size_t i = parents_first.size(); i-- > 0;) {
    const auto& cluster = tree.clusters[parents_first[i]];
    bool any = false;
    for (const SurfaceId s : cluster.surfaces)
      any = any || live[side_of(s, false)] || live[side_of(s, true)];
    for (const std::uint32_t child : cluster.clusters) any = any || result[child];
    result[parents_first[i]] = any;
  }
  return result;
}

}  // namespace

ElementTree::ElementTree(const Geometry& geometry, const Surfaces& surfaces,
                         const ClusterTree& clusters, const IdVector<SideId, std::uint8_t>& live)
    : geometry_(&geometry), surfaces_(&surfaces), side_roots_(2 * surfaces.surfaces.size()) {
  const std::vector<bool> used = inhabited(clusters, live);
  std::vector<std::pair<ElementId, std::uint32_t>> open{{ElementId(0), clusters.root}};
  elements_.reserve(static_cast<std::size_t>(std::count(used.begin(), used.end(), true) +
                                             std::count(live.begin(), live.end(), 1)) +
                    1);
  elements_.push_back({});
  levels_ = {{0, 1}};
  for (std::size_t next = 0; next < open.size(); ++next) {
    const auto [parent, cluster_index] = open[next];
    const auto& cluster = clusters.clusters[cluster_index];
    const auto first = static_cast<std::uint32_t>(elements_.size());
    for (const std::uint32_t child : cluster.clusters) {
      if (!used[child]) continue;
      open.emplace_back(ElementId(elements_.size()), child);
      elements_.push_back({});
      elements_.back().parent = parent;
    }
    for (const SurfaceId s : cluster.surfaces)
      for (const bool back : {false, true}) {
        const SideId side = side_of(s, back);
        if (!live[side]) continue;
        Element e;
        e.parent = parent;
        e.side = side;
        e.box = surfaces[s].box;
        e.area = surfaces[s].area;
        e.cell_lower = surfaces[s].uv_lower;
        e.cell_upper = surfaces[s].uv_upper;
        side_roots_[side] = elements_.push_back(e);
      }
    const auto last = static_cast<std::uint32_t>(elements_.size());
    elements_[parent].first_child = first;
    elements_[parent].child_count = last - first;
    if (parent.value >= levels_.back().first) levels_.push_back({first, first});
    levels_.back().last = last;
  }
  initial_size_ = elements_.size();
  crossings_.resize(initial_size_);
  cluster_total_ = open.size();
  cluster_elements_.resize(clusters.clusters.size());
  for (const auto& [element, cluster] : open) cluster_elements_[cluster] = element;
  for (std::size_t i = elements_.size(); i-- > 1;) {
    const Element& e = elements_[ElementId(i)];
    elements_[e.parent].box.extend(e.box);
    elements_[e.parent].area += e.area;
  }
}

float ElementTree::cell_size(ElementId cell) const {
  const Vec2 extent = elements_[cell].cell_upper - elements_[cell].cell_lower;
  return std::max(extent.x, extent.y);
}

// Splits a convex polygon by the line x[axis] = at into its lower and upper part.
void ElementTree::split_polygon(TriangleId triangle, std::span<const Vec2> polygon, int axis,
                                float at, std::vector<Fragment>* halves,
                                std::vector<Vec2>* corners) const {
  for (int half = 0; half < 2; ++half) {
    const float sign = half == 0 ? 1.f : -1.f;
    Fragment f{triangle, static_cast<std::uint32_t>(corners[half].size()), 0, 0.f};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const float da = sign * (at - a[axis]), db = sign * (at - b[axis]);
      if (da >= 0.f) corners[half].push_back(a);
      if ((da > 0.f && db < 0.f) || (da < 0.f && db > 0.f)) {
        Vec2 cut = a + (b - a) * (da / (da - db));
        cut[axis] = at;
        corners[half].push_back(cut);
      }
    }
    f.corner_count = static_cast<std::uint32_t>(corners[half].size()) - f.first_corner;
    const float area = polygon_area({corners[half].data() + f.first_corner, f.corner_count});
    if (f.corner_count < 3 || !(area > 0.f)) {
      corners[half].resize(f.first_corner);
      continue;
    }
    f.cumulative_area = area + (halves[half].empty() ? 0.f : halves[half].back().cumulative_area);
    halves[half].push_back(f);
  }
}

void ElementTree::split(ElementId cell) {
  const Element parent = elements_[cell];
  const Surface& surface = (*surfaces_)[parent.side];
  const Vec2 extent = parent.cell_upper - parent.cell_lower;
  const int axis = extent.x >= extent.y ? 0 : 1;
  const float at = 0.5f * (parent.cell_lower[axis] + parent.cell_upper[axis]);

  std::array<std::vector<Fragment>, 2> halves;
  std::array<std::vector<Vec2>, 2> corners;
  if (parent.fragment_count == 0) {
    for (std::uint32_t i = 0; i < surface.triangle_count; ++i) {
      const TriangleId t = surfaces_->triangles[surface.first_triangle + i];
      std::array<Vec2, 3> polygon;
      const auto world = geometry_->corners(t);
      for (int k = 0; k < 3; ++k) polygon[k] = surface.to_plane(world[k]);
      split_polygon(t, polygon, axis, at, halves.data(), corners.data());
    }
  } else {
    for (std::uint32_t i = 0; i < parent.fragment_count; ++i) {
      const Fragment& f = fragments_[parent.first_fragment + i];
      split_polygon(f.triangle, corners_of(f), axis, at, halves.data(), corners.data());
    }
  }

  const auto first = static_cast<std::uint32_t>(elements_.size());
  for (int half = 0; half < 2; ++half) {
    if (halves[half].empty()) continue;
    Element child;
    child.parent = cell;
    child.side = parent.side;
    child.cell_lower = parent.cell_lower;
    child.cell_upper = parent.cell_upper;
    (half == 0 ? child.cell_upper : child.cell_lower)[axis] = at;
    child.area = halves[half].back().cumulative_area;
    child.first_fragment = static_cast<std::uint32_t>(fragments_.size());
    child.fragment_count = static_cast<std::uint32_t>(halves[half].size());
    const auto corner_base = static_cast<std::uint32_t>(fragment_corners_.size());
    for (Fragment& f : halves[half]) f.first_corner += corner_base;
    fragments_.insert(fragments_.end(), halves[half].begin(), halves[half].end());
    fragment_corners_.insert(fragment_corners_.end(), corners[half].begin(), corners[half].end());
    for (const Vec2& c : corners[half]) child.box.extend(surface.to_world(c));
    elements_.push_back(child);
  }
  elements_[cell].first_child = first;
  elements_[cell].child_count = static_cast<std::uint32_t>(elements_.size()) - first;
  crossings_.resize(elements_.size());
  crossings_[cell] = {first & 0x3fffffffu, static_cast<std::uint32_t>(axis) & 1u,
                      elements_[cell].child_count == 1 ? 1u : 0u, at};
}

CellPoint ElementTree::sample(ElementId cell, Vec2 u) const {
  const Element& e = elements_[cell];
  const Surface& surface = (*surfaces_)[e.side];
  // The first coordinate picks the piece by area and is stretched to be used again within it.
  float wanted = u.x * e.area;
  if (e.fragment_count == 0) {
    const std::size_t i = pick(surfaces_->cumulative_area, surface.first_triangle,
                               surface.triangle_count, wanted, [](float a) { return a; });
    const float before = i == surface.first_triangle ? 0.f : surfaces_->cumulative_area[i - 1];
    const float within = std::max(surfaces_->cumulative_area[i] - before, 1e-30f);
    const Vec2 b = uniform_triangle({std::clamp((wanted - before) / within, 0.f, 1.f), u.y});
    const TriangleId t = surfaces_->triangles[i];
    const auto c = geometry_->corners(t);
    return {c[0] + b.x * (c[1] - c[0]) + b.y * (c[2] - c[0]), t};
  }
  const std::size_t i = pick(fragments_, e.first_fragment, e.fragment_count, wanted,
                             [](const Fragment& f) { return f.cumulative_area; });
  const Fragment& f = fragments_[i];
  wanted -= i == e.first_fragment ? 0.f : fragments_[i - 1].cumulative_area;
  const auto corners = corners_of(f);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const float area = polygon_area(std::array{corners[0], corners[k], corners[k + 1]});
    if (wanted >= area && k + 2 < corners.size()) {
      wanted -= area;
      continue;
    }
    const Vec2 b = uniform_triangle({std::clamp(wanted / std::max(area, 1e-30f), 0.f, 1.f), u.y});
    const Vec2 at =
        corners[0] + b.x * (corners[k] - corners[0]) + b.y * (corners[k + 1] - corners[0]);
    return {surface.to_world(at), f.triangle};
  }
  return {surface.to_world(corners[0]), f.triangle};
}

ElementId ElementTree::find_leaf(SideId side, const Vec3& position) const {
  ElementId at = side_roots_[side];
  if (!at.valid()) return at;
  const Vec2 uv = (*surfaces_)[side].to_plane(position);
  for (Crossing c = crossings_[at]; c.first_child != 0; c = crossings_[at])
    at = ElementId(c.first_child + (c.only_child == 0 && uv[c.axis] > c.boundary ? 1 : 0));
  return at;
}

}  // namespace halflight
