#include "halflight/hierarchy/kd_tree.h"

#include <algorithm>

#include "halflight/base/parallel.h"
#include "halflight/hierarchy/fan_out.h"

namespace halflight {
namespace {

// A cut in the middle of the cell that leaves more than this share on one side is tried again at
// the median: depth and work stay within n log n.
constexpr double kOneSided = 0.875;

struct KdPart {
  Bounds3f box;
  std::uint32_t surface = 0;
};

struct KdCell {
  std::uint32_t cluster = 0;
  std::size_t first = 0, last = 0;  // of the parts
  Bounds3f box;
  // After the cut: [first, lower) straddles, [lower, upper) lies below the plane, the rest above.
  std::size_t lower = 0, upper = 0;
  int axis = 0;
  float plane = 0.f;
  std::uint64_t steps = 0;

  std::size_t count() const { return last - first; }
  std::size_t largest_side() const { return std::max(upper - lower, last - upper); }
};

void cut_at(KdCell& cell, std::span<KdPart> parts, int axis, float plane) {
  cell.axis = axis;
  cell.plane = plane;
  cell.steps += cell.count();
  const auto begin = parts.begin() + static_cast<std::ptrdiff_t>(cell.first);
  const auto end = parts.begin() + static_cast<std::ptrdiff_t>(cell.last);
  // A flat part in the plane lies below.
  const auto above = std::partition(begin, end, [&](const KdPart& p) {
    return p.box.lower[axis] < plane || p.box.upper[axis] <= plane;
  });
  const auto below =
      std::partition(begin, above, [&](const KdPart& p) { return p.box.upper[axis] > plane; });
  cell.lower = static_cast<std::size_t>(below - parts.begin());
  cell.upper = static_cast<std::size_t>(above - parts.begin());
}

bool one_sided(const KdCell& cell) {
  return static_cast<double>(cell.largest_side()) > kOneSided * static_cast<double>(cell.count());
}

void cut_at_median(KdCell& cell, std::span<KdPart> parts) {
  const std::span<KdPart> own = parts.subspan(cell.first, cell.count());
  Bounds3f centers;
  for (const KdPart& p : own) centers.extend(p.box.center());
  const int axis = centers.longest_axis();
  std::vector<float> along(own.size());
  for (std::size_t i = 0; i < along.size(); ++i) along[i] = own[i].box.center()[axis];
  const auto middle = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
  std::nth_element(along.begin(), middle, along.end());
  cell.steps += 2 * own.size();
  cut_at(cell, parts, axis, *middle);
}

// False: the cell stays whole.
bool cut(KdCell& cell, std::span<KdPart> parts, std::size_t most_in_cell) {
  if (cell.count() <= most_in_cell) return false;
  const int axis = cell.box.longest_axis();
  cut_at(cell, parts, axis, cell.box.center()[axis]);
  if (one_sided(cell)) cut_at_median(cell, parts);
  return !one_sided(cell);
}

}  // namespace

ClusterTree build_kd_tree(std::span<const Bounds3f> boxes, const KdTreeOptions& options,
                          std::uint64_t* steps) {
  std::vector<KdPart> parts(boxes.size());
  Bounds3f scene;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    parts[i] = {boxes[i], i};
    scene.extend(boxes[i]);
  }
  ClusterTree tree;
  tree.clusters.resize(1);
  if (options.whole_cells) tree.volumes.push_back(scene);
  const auto attach = [&](std::uint32_t cluster, std::size_t first, std::size_t last) {
    std::vector<SurfaceId>& surfaces = tree.clusters[cluster].surfaces;
    surfaces.reserve(surfaces.size() + last - first);
    for (std::size_t i = first; i < last; ++i) surfaces.emplace_back(parts[i].surface);
    std::sort(surfaces.begin(), surfaces.end());
  };

  // Level by level: the cells of one level own disjoint runs of the parts.
  std::vector<KdCell> level{{.cluster = 0, .first = 0, .last = parts.size(), .box = scene}};
  while (!level.empty()) {
    std::vector<std::uint8_t> was_cut(level.size());
    parallel_for(level.size(), 1,
                 [&](std::size_t i) { was_cut[i] = cut(level[i], parts, options.most_in_cell); });
    std::vector<KdCell> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const KdCell& cell = level[i];
      if (steps) *steps += cell.steps;
      if (!was_cut[i]) {
        attach(cell.cluster, cell.first, cell.last);
        continue;
      }
      attach(cell.cluster, cell.first, cell.lower);
      for (const bool above : {false, true}) {
        KdCell child;
        child.first = above ? cell.upper : cell.lower;
        child.last = above ? cell.last : cell.upper;
        child.box = cell.box;
        (above ? child.box.lower : child.box.upper)[cell.axis] = cell.plane;
        if (child.count() == 0) continue;
        if (child.count() == 1) {
          attach(cell.cluster, child.first, child.last);
          continue;
        }
        child.cluster = static_cast<std::uint32_t>(tree.clusters.size());
        tree.clusters.emplace_back();
        tree.clusters[cell.cluster].clusters.push_back(child.cluster);
        if (options.whole_cells) tree.volumes.push_back(child.box);
        next.push_back(child);
      }
    }
    level = std::move(next);
  }
  if (!options.whole_cells) limit_fan_out(tree, boxes, options.largest_fan_out);
  return tree;
}

}  // namespace halflight
