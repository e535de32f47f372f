// The builders of cluster trees behind one door. Each has its own file, and a page in
// docs/algorithms; docs/design/hierarchies.md compares them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/hierarchy/surface_shape.h"

namespace halflight {

enum class HierarchyKind : std::uint8_t { size_grid, kd_tree, goldsmith_salmon, agglomerative };

struct NamedHierarchy {
  HierarchyKind kind;
  std::string_view name;  // on the command line and in reports
};
inline constexpr std::array kHierarchies{
    NamedHierarchy{HierarchyKind::size_grid, "size-grid"},
    NamedHierarchy{HierarchyKind::kd_tree, "kd-tree"},
    NamedHierarchy{HierarchyKind::goldsmith_salmon, "goldsmith-salmon"},
    NamedHierarchy{HierarchyKind::agglomerative, "agglomerative"}};
std::string_view name_of(HierarchyKind kind);

// Every surface comes into exactly one cluster; the same tree for any thread count. `steps`, when
// given, grows by the comparisons made: of boxes with each other or with planes.
ClusterTree build_hierarchy(HierarchyKind kind, std::span<const SurfaceShape> shapes,
                            std::uint64_t* steps = nullptr);
// Finds out about the surfaces what this kind needs to know.
ClusterTree build_hierarchy(HierarchyKind kind, const Surfaces& surfaces);

}  // namespace halflight
