#include "halflight/hierarchy/fan_out.h"

#include <algorithm>

#include "halflight/base/morton.h"

namespace halflight {
namespace {

using SurfaceRun = std::span<const SurfaceId>;

// Cuts the run into at most `parts` equal parts: those of one surface are attached to the cluster,
// the others become children.
void attach_in_parts(ClusterTree& tree, std::uint32_t cluster, SurfaceRun run, std::size_t parts,
                     std::size_t fan_out) {
  parts = std::min(parts, run.size());
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t first = p * run.size() / parts, last = (p + 1) * run.size() / parts;
    if (last - first == 1) {
      tree.clusters[cluster].surfaces.push_back(run[first]);
      continue;
    }
    const auto child = static_cast<std::uint32_t>(tree.clusters.size());
    tree.clusters.emplace_back();
    tree.clusters[cluster].clusters.push_back(child);
    attach_in_parts(tree, child, run.subspan(first, last - first), fan_out, fan_out);
  }
}

}  // namespace

void limit_fan_out(ClusterTree& tree, std::span<const Bounds3f> boxes, std::size_t largest) {
  Bounds3f scene;
  for (const Bounds3f& box : boxes) scene.extend(box);
  for (std::uint32_t c = 0, n = static_cast<std::uint32_t>(tree.clusters.size()); c < n; ++c) {
    const std::size_t children = tree.clusters[c].clusters.size();
    if (children + tree.clusters[c].surfaces.size() <= largest) continue;
    std::vector<std::pair<std::uint64_t, SurfaceId>> along_curve;
    for (const SurfaceId s : tree.clusters[c].surfaces)
      along_curve.emplace_back(morton_code(boxes[s.value].center(), scene), s);
    std::sort(along_curve.begin(), along_curve.end());
    std::vector<SurfaceId> sorted;
    sorted.reserve(along_curve.size());
    for (const auto& [code, s] : along_curve) sorted.push_back(s);
    tree.clusters[c].surfaces.clear();
    attach_in_parts(tree, c, sorted, largest - children, largest);
  }
}

}  // namespace halflight
