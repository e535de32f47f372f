// The one tree of the solver (Sillion's H-elements): clusters > sides of surfaces > their cells.
// An element is either a cluster or a cell of one side of a surface; a side's first cell is its
// whole surface, and cells split in two across their longer side in the surface's own plane, so
// meshing does not depend on the triangles of the file.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/hierarchy/surfaces.h"

namespace halflight {

using ElementId = Id<struct ElementTag>;

struct Element {
  Bounds3f box;
  float area = 0.f;  // of the cell, or of all sides inside the cluster
  ElementId parent;
  std::uint32_t first_child = 0;  // children are consecutive and come after their parent
  std::uint32_t child_count = 0;
  SideId side;                            // invalid: a cluster
  Vec2 cell_lower{0.f}, cell_upper{0.f};  // rectangle in the surface's plane
  std::uint32_t first_fragment = 0;       // none: the cell is the whole surface
  std::uint32_t fragment_count = 0;

  bool is_cluster() const { return !side.valid(); }
  bool is_leaf() const { return child_count == 0; }
  bool is_leaf_cell() const { return is_leaf() && !is_cluster(); }
  IdRange<ElementId> children() const { return {first_child, first_child + child_count}; }
  Vec3 center() const { return box.center(); }
  float diameter() const { return box.diagonal(); }
};

// A convex piece of one triangle inside a cell.
struct Fragment {
  TriangleId triangle;
  std::uint32_t first_corner = 0;  // in the surface's plane
  std::uint32_t corner_count = 0;
  float cumulative_area = 0.f;  // within its cell, after this fragment
};

struct CellPoint {
  Vec3 position{0.f};
  TriangleId triangle;
};

class ElementTree {
 public:
  // `live` says of every side whether it can ever see light; the others get no element.
  ElementTree(const Geometry& geometry, const Surfaces& surfaces, const ClusterTree& clusters,
              const IdVector<SideId, std::uint8_t>& live);

  ElementId root() const { return ElementId(0); }
  std::size_t size() const { return elements_.size(); }
  std::size_t initial_size() const { return initial_size_; }  // clusters and whole sides come first
  std::size_t cluster_total() const { return cluster_total_; }
  // Clusters and whole sides as they lie below the root: all of depth d are consecutive.
  std::size_t depth() const { return levels_.size(); }
  IdRange<ElementId> level(std::size_t d) const { return levels_[d]; }
  const Element& operator[](ElementId id) const { return elements_[id]; }
  const Surfaces& surfaces() const { return *surfaces_; }
  const Geometry& geometry() const { return *geometry_; }
  Vec3 normal(ElementId cell) const { return surfaces_->normal(elements_[cell].side); }
  // The whole-surface cell of a side; invalid when the side is not live.
  ElementId side_root(SideId side) const { return side_roots_[side]; }

  // The element of a cluster of the tree that this one was made from; invalid when nothing in it
  // is live.
  ElementId cluster_element(std::uint32_t cluster) const { return cluster_elements_[cluster]; }

  // The element or one above it is `ancestor`.
  bool contains(ElementId ancestor, ElementId element) const {
    while (element.value > ancestor.value) element = elements_[element].parent;
    return element == ancestor;  // parents have smaller ids
  }

  // Halves a leaf cell across its longer side. Parts that hold nothing of the surface are left out,
  // so a cell may get a single child.
  void split(ElementId cell);
  // Longer side of the cell's rectangle, metres.
  float cell_size(ElementId cell) const;

  // A point uniform over the area of a cell. u is in [0, 1)^2.
  CellPoint sample(ElementId cell, Vec2 u) const;
  // The leaf cell of a side at a point of its surface; invalid when the side is not live.
  ElementId find_leaf(SideId side, const Vec3& position) const;
  // The leaf cell that a ray has met.
  ElementId leaf_hit(const RayHit& hit) const {
    return find_leaf(surfaces_->side_hit(hit), hit_position(*geometry_, hit));
  }
  // Calls visit(span of corners in world space) for each convex piece of a cell.
  template <class Visit>
  void for_each_piece(ElementId cell, const Visit& visit) const;

 private:
  std::span<const Vec2> corners_of(const Fragment& f) const {
    return {fragment_corners_.data() + f.first_corner, f.corner_count};
  }
  void split_polygon(TriangleId triangle, std::span<const Vec2> polygon, int axis, float at,
                     std::vector<Fragment>* halves, std::vector<Vec2>* corners) const;

  // All that a search for a leaf needs of an element, packed for the cache.
  struct Crossing {
    std::uint32_t first_child : 30 = 0;  // 0: a leaf
    std::uint32_t axis : 1 = 0;
    std::uint32_t only_child : 1 = 0;
    float boundary = 0.f;  // beyond it lies the second child
  };

  const Geometry* geometry_;
  const Surfaces* surfaces_;
  IdVector<ElementId, Element> elements_;
  IdVector<ElementId, Crossing> crossings_;  // of cells
  IdVector<SideId, ElementId> side_roots_;
  std::vector<ElementId> cluster_elements_;
  std::vector<IdRange<ElementId>> levels_;
  std::vector<Fragment> fragments_;
  std::vector<Vec2> fragment_corners_;
  std::size_t initial_size_ = 0, cluster_total_ = 0;
};

template <class Visit>
void ElementTree::for_each_piece(ElementId cell, const Visit& visit) const {
  const Element& e = elements_[cell];
  const Surface& surface = (*surfaces_)[e.side];
  if (e.fragment_count == 0) {
    for (std::uint32_t i = 0; i < surface.triangle_count; ++i) {
      const auto corners = geometry_->corners(surfaces_->triangles[surface.first_triangle + i]);
      visit(std::span<const Vec3>(corners));
    }
    return;
  }
  std::array<Vec3, 16> corners;  // a triangle clipped by a rectangle has at most 7
  for (std::uint32_t i = 0; i < e.fragment_count; ++i) {
    const std::span<const Vec2> flat = corners_of(fragments_[e.first_fragment + i]);
    const std::size_t n = std::min(flat.size(), corners.size());
    for (std::size_t k = 0; k < n; ++k) corners[k] = surface.to_world(flat[k]);
    visit(std::span<const Vec3>(corners.data(), n));
  }
}

// Visits an element and all below it, parents before their children.
template <class Visit>
void for_all_below(const ElementTree& tree, ElementId top, const Visit& visit) {
  std::vector<ElementId> open{top};
  while (!open.empty()) {
    const ElementId e = open.back();
    open.pop_back();
    visit(e);
    for (const ElementId child : tree[e].children()) open.push_back(child);
  }
}

}  // namespace halflight
