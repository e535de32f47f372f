#include "halflight/hierarchy/build_hierarchy.h"

#include "halflight/hierarchy/agglomerative.h"
#include "halflight/hierarchy/goldsmith_salmon.h"
#include "halflight/hierarchy/kd_tree.h"
#include "halflight/hierarchy/size_grid.h"

namespace halflight {
namespace {

ClusterTree build_over_boxes(HierarchyKind kind, std::span<const Bounds3f> boxes,
                             std::uint64_t* steps) {
  switch (kind) {
    case HierarchyKind::kd_tree:
      return build_kd_tree(boxes, {}, steps);
    case HierarchyKind::goldsmith_salmon:
      return build_goldsmith_salmon(boxes, {}, steps);
    default:
      return build_size_grid(boxes, {}, steps);
  }
}

}  // namespace

std::string_view name_of(HierarchyKind kind) {
  for (const NamedHierarchy& h : kHierarchies)
    if (h.kind == kind) return h.name;
  return {};
}

ClusterTree build_hierarchy(HierarchyKind kind, std::span<const SurfaceShape> shapes,
                            std::uint64_t* steps) {
  if (kind == HierarchyKind::agglomerative) return build_agglomerative(shapes, {}, steps);
  std::vector<Bounds3f> boxes(shapes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = shapes[i].box;
  return build_over_boxes(kind, boxes, steps);
}

ClusterTree build_hierarchy(HierarchyKind kind, const Surfaces& surfaces) {
  if (kind == HierarchyKind::agglomerative) return build_agglomerative(surface_shapes(surfaces));
  std::vector<Bounds3f> boxes(surfaces.surfaces.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = surfaces[SurfaceId(i)].box;
  return build_over_boxes(kind, boxes, nullptr);
}

}  // namespace halflight
