#include "halflight/visibility/multires_build.h"

#include <cassert>

#include "halflight/base/parallel.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/split_boxes.h"

namespace halflight {
namespace {

constexpr int kDeepestCluster = 64;     // below, clusters no longer count: their triangles do
constexpr int kDeepestHeuristic = 80;   // below, splits are even, so that the depth stays bounded
constexpr float kInflation = 0x1p-16f;  // of the largest coordinate: twice what RayScene::lift is

// What may become a slot.
struct SlotItem {
  enum class Kind { cluster, triangles, bundle };
  Kind kind = Kind::bundle;
  bool ends = false;        // the surfaces of one cluster: where average visibility ends
  bool inside_end = false;  // a part of such
  Bounds3f box;
  float blocking_area = 0.f;
  std::uint32_t count = 0;            // triangles
  std::uint32_t cluster = 0;          // deepest that holds it all
  std::uint32_t first = 0, last = 0;  // triangles: range of the builder's parts
  std::vector<SlotItem> members;      // bundle

  bool is_leaf() const { return kind == Kind::triangles && count <= kWide; }
};

class MultiresBuilder {
 public:
  MultiresBuilder(const Scene& scene, const Geometry& geometry, const Surfaces& surfaces,
                  const ClusterTree& clusters)
      : scene_(scene), geometry_(geometry), surfaces_(surfaces), clusters_(clusters) {
    areas_ = blocking_areas(scene, geometry, surfaces.bodies);
    if (!geometry.triangles.empty()) inflation_ = kInflation * geometry.bounds.farthest();
    take_clusters();
  }

  MultiresNodes build() {
    if (summaries_[clusters_.root].count == 0) return std::move(out_);
    struct Task {
      std::uint32_t node, cluster;
      int depth;
      std::vector<SlotItem> items;
    };
    std::vector<Task> stack;
    append_nodes(1);
    stack.push_back({0, clusters_.root, 0, members(summaries_[clusters_.root], 0)});
    while (!stack.empty()) {
      Task task = std::move(stack.back());
      stack.pop_back();
      assert(task.depth < 140);  // kTraversalStack is made for that
      fit(task.items, task.cluster, task.depth);
      fill(task.node, task.items);
      // Last in, first out: the blocks below a slot stay together.
      for (std::uint32_t i = out_.nodes[task.node].node_count; i-- > 0;)
        stack.push_back({out_.nodes[task.node].first_node + i, task.items[i].cluster,
                         task.depth + 1, members(task.items[i], task.depth + 1)});
    }
    take_contents();
    std::vector<float> extinctions(out_.contents.size());
    for (std::size_t slot = 0; slot < extinctions.size(); ++slot)
      if (out_.has(slot))
        extinctions[slot] = extinction(out_.blocking_areas[slot], out_.box_of(slot));
    out_.store_extinctions(extinctions);
    return std::move(out_);
  }

 private:
  void take_part(SurfaceId surface) {
    const Surface& s = surfaces_[surface];
    for (std::uint32_t i = 0; i < s.triangle_count; ++i) {
      const TriangleId t = surfaces_.triangles[s.first_triangle + i];
      Bounds3f box;
      for (const Vec3& corner : geometry_.corners(t)) box.extend(corner);
      parts_.push_back({box, t.value, 1});
    }
  }

  // Boxes, areas and triangle counts of all clusters, children before parents.
  void take_clusters() {
    summaries_.resize(clusters_.clusters.size());
    attached_.resize(clusters_.clusters.size());
    parts_.reserve(geometry_.triangles.size());
    std::vector<std::uint32_t> order{clusters_.root};
    for (std::size_t i = 0; i < order.size(); ++i)
      for (const std::uint32_t child : clusters_.clusters[order[i]].clusters)
        order.push_back(child);
    for (std::size_t i = order.size(); i-- > 0;) {
      const std::uint32_t c = order[i];
      const ClusterTree::Cluster& cluster = clusters_.clusters[c];
      SlotItem& attached = attached_[c];
      attached.first = static_cast<std::uint32_t>(parts_.size());
      for (const SurfaceId s : cluster.surfaces) take_part(s);
      attached = triangles_item(attached.first, static_cast<std::uint32_t>(parts_.size()), c);
      attached.ends = cluster.surfaces.size() <= kWide;
      SlotItem& summary = summaries_[c];
      summary = attached;
      summary.kind = SlotItem::Kind::cluster;
      summary.ends = false;
      for (const std::uint32_t child : cluster.clusters) add_to(summary, summaries_[child]);
    }
  }

  static void add_to(SlotItem& item, const SlotItem& member) {
    item.box.extend(member.box);
    item.blocking_area += member.blocking_area;
    item.count += member.count;
  }

  SlotItem triangles_item(std::uint32_t first, std::uint32_t last, std::uint32_t cluster) const {
    SlotItem item;
    item.kind = SlotItem::Kind::triangles;
    item.cluster = cluster;
    item.first = first;
    item.last = last;
    item.count = last - first;
    for (std::uint32_t i = first; i < last; ++i) {
      item.box.extend(parts_[i].box);
      item.blocking_area += areas_[TriangleId(parts_[i].index)];
    }
    return item;
  }

  // All triangles of a cluster as one range, for cluster trees of excessive depth.
  SlotItem gather_triangles(const SlotItem& cluster) {
    const auto first = static_cast<std::uint32_t>(parts_.size());
    std::vector<std::uint32_t> stack{cluster.cluster};
    while (!stack.empty()) {
      const std::uint32_t c = stack.back();
      stack.pop_back();
      for (const SurfaceId s : clusters_.clusters[c].surfaces) take_part(s);
      for (const std::uint32_t child : clusters_.clusters[c].clusters) stack.push_back(child);
    }
    return triangles_item(first, static_cast<std::uint32_t>(parts_.size()), cluster.cluster);
  }

  std::vector<SlotItem> members(const SlotItem& item, int depth) {
    switch (item.kind) {
      case SlotItem::Kind::bundle:
        return item.members;
      case SlotItem::Kind::triangles:
        return split_triangles(item, depth);
      case SlotItem::Kind::cluster:
        break;
    }
    if (depth > kDeepestCluster) return {gather_triangles(item)};
    std::vector<SlotItem> items;
    for (const std::uint32_t child : clusters_.clusters[item.cluster].clusters)
      if (summaries_[child].count > 0) items.push_back(summaries_[child]);
    if (attached_[item.cluster].count > 0) items.push_back(attached_[item.cluster]);
    return items;
  }

  std::vector<SlotItem> split_triangles(const SlotItem& item, int depth) {
    const std::span<BoxedPart> range(parts_.data() + item.first, item.count);
    const auto begins = split_boxes_into(range, kWide, kWide, depth < kDeepestHeuristic);
    std::vector<SlotItem> items;
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
      items.push_back(triangles_item(item.first + static_cast<std::uint32_t>(begins[i]),
                                     item.first + static_cast<std::uint32_t>(begins[i + 1]),
                                     item.cluster));
      items.back().inside_end = item.ends || item.inside_end;
    }
    return items;
  }

  // Makes the items the slots of one node: few take in the members of the largest among them, too
  // many are bundled.
  void fit(std::vector<SlotItem>& items, std::uint32_t cluster, int depth) {
    for (bool opened = true; opened && items.size() <= kWide;) {
      opened = false;
      std::vector<std::size_t> by_area;
      for (std::size_t i = 0; i < items.size(); ++i)
        if (may_open(items[i], items.size())) by_area.push_back(i);
      std::stable_sort(by_area.begin(), by_area.end(), [&](std::size_t a, std::size_t b) {
        return items[a].box.surface_area() > items[b].box.surface_area();
      });
      for (const std::size_t i : by_area) {
        std::vector<SlotItem> inside = members(items[i], depth);
        if (items.size() - 1 + inside.size() > kWide) continue;
        items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
        items.insert(items.end(), std::make_move_iterator(inside.begin()),
                     std::make_move_iterator(inside.end()));
        opened = true;
        break;
      }
    }
    if (items.size() > kWide) bundle(items, cluster, depth);
    std::stable_partition(items.begin(), items.end(),
                          [](const SlotItem& i) { return !i.is_leaf(); });
    // Rays look first into the last node of a row: what blocks most may end them at once.
    const auto nodes =
        std::find_if(items.begin(), items.end(), [](const auto& i) { return i.is_leaf(); });
    std::stable_sort(items.begin(), nodes, [](const SlotItem& a, const SlotItem& b) {
      return a.blocking_area < b.blocking_area;
    });
    for (SlotItem& item : items)
      if (item.is_leaf() && !item.inside_end) item.ends = true;
  }

  // A range of triangles is only worth opening where it would be alone in its node.
  static bool may_open(const SlotItem& item, std::size_t siblings) {
    if (item.kind != SlotItem::Kind::triangles) return true;
    return siblings == 1 && !item.is_leaf() && !item.ends;
  }

  static void bundle(std::vector<SlotItem>& items, std::uint32_t cluster, int depth) {
    std::vector<BoxedPart> boxes(items.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) boxes[i] = {items[i].box, i, items[i].count};
    const auto begins = split_boxes_into(boxes, kWide, 0, depth < kDeepestHeuristic);
    std::vector<SlotItem> bundles;
    for (std::size_t b = 0; b + 1 < begins.size(); ++b) {
      SlotItem all;
      all.cluster = cluster;
      for (std::size_t i = begins[b]; i < begins[b + 1]; ++i) {
        add_to(all, items[boxes[i].index]);
        all.members.push_back(std::move(items[boxes[i].index]));
      }
      if (all.members.size() == 1) {
        SlotItem only = std::move(all.members.front());
        bundles.push_back(std::move(only));
      } else {
        bundles.push_back(std::move(all));
      }
    }
    items = std::move(bundles);
  }

  void append_nodes(std::size_t n) {
    out_.nodes.resize(out_.nodes.size() + n);
    out_.contents.resize(kWide * out_.nodes.size());
    out_.blocking_areas.resize(kWide * out_.nodes.size());
  }

  // Numerics want boxes of some thickness that hold what is lifted off their surfaces.
  Bounds3f stored_box(const SlotItem& item) const {
    const Bounds3f box = thickened(item.box);
    return {box.lower - inflation_, box.upper + inflation_};
  }

  void fill(std::uint32_t at, const std::vector<SlotItem>& items) {
    MultiresNode node;
    node.slot_count = static_cast<std::uint8_t>(items.size());
    for (const SlotItem& item : items) node.node_count += !item.is_leaf();
    node.first_node = static_cast<std::uint32_t>(out_.nodes.size());
    node.first_block = static_cast<std::uint32_t>(out_.blocks.size());
    append_nodes(node.node_count);
    Bounds3f all;
    for (const SlotItem& item : items) all.extend(stored_box(item));
    node.origin = all.lower;
    node.scale = all.extent() * ((1.f + 0x1p-20f) / 255.f);
    for (std::size_t i = 0; i < items.size(); ++i) {
      store_bounds(node, i, stored_box(items[i]));
      if (items[i].ends) node.ends |= static_cast<std::uint8_t>(1u << i);
      out_.blocking_areas[kWide * at + i] = items[i].blocking_area;
      out_.contents[kWide * at + i].cluster = items[i].cluster;
      if (items[i].is_leaf()) out_.blocks.push_back(block_of(items[i]));
    }
    out_.nodes[at] = node;
  }

  static void store_bounds(MultiresNode& node, std::size_t slot, const Bounds3f& box) {
    for (int axis = 0; axis < 3; ++axis) {
      const float scale = node.scale[axis], origin = node.origin[axis];
      int low = static_cast<int>((box.lower[axis] - origin) / scale);
      int high = static_cast<int>(std::ceil((box.upper[axis] - origin) / scale));
      while (low > 0 && origin + scale * static_cast<float>(low) > box.lower[axis]) --low;
      while (high < 255 && origin + scale * static_cast<float>(high) < box.upper[axis]) ++high;
      node.bounds[MultiresNode::lower_row(axis)][slot] =
          static_cast<std::uint8_t>(std::clamp(low, 0, 254));
      node.bounds[MultiresNode::lower_row(axis) + 1][slot] =
          static_cast<std::uint8_t>(std::clamp(high, low + 1, 255));
    }
  }

  TriangleBlock block_of(const SlotItem& item) const {
    TriangleBlock block;
    for (std::uint32_t i = 0; i < item.count; ++i) {
      const TriangleId t(parts_[item.first + i].index);
      block.triangles[i] = t;
      block.used |= static_cast<std::uint8_t>(1u << i);
      if (may_be_transparent(scene_.materials[geometry_.materials[t]]))
        block.transparent |= static_cast<std::uint8_t>(1u << i);
      const auto corners = geometry_.corners(t);
      for (int k = 0; k < 9; ++k) block.corners[k][i] = corners[k / 3][k % 3];
    }
    return block;
  }

  // Children come after their node, so that a backward sweep knows what is below each.
  void take_contents() {
    std::vector<MultiresNodes::Contents> below(out_.nodes.size());
    for (std::size_t n = out_.nodes.size(); n-- > 0;) {
      const MultiresNode& node = out_.nodes[n];
      below[n] = {node.first_block, node.first_block, 0};
      for (std::uint32_t i = 0; i < node.slot_count; ++i) {
        MultiresNodes::Contents& slot = out_.contents[kWide * n + i];
        const std::uint32_t block = node.first_block + i - node.node_count;
        slot.first_block = i < node.node_count ? below[node.first_node + i].first_block : block;
        slot.last_block = i < node.node_count ? below[node.first_node + i].last_block : block + 1;
        below[n].last_block = std::max(below[n].last_block, slot.last_block);
      }
    }
  }

  const Scene& scene_;
  const Geometry& geometry_;
  const Surfaces& surfaces_;
  const ClusterTree& clusters_;
  IdVector<TriangleId, float> areas_;
  float inflation_ = 0.f;
  std::vector<BoxedPart> parts_;
  std::vector<SlotItem> summaries_;  // of each cluster
  std::vector<SlotItem> attached_;   // what hangs directly on each cluster
  MultiresNodes out_;
};

}  // namespace

ClusterTree one_cluster(const Surfaces& surfaces) {
  ClusterTree tree;
  tree.clusters.resize(1);
  for (std::size_t s = 0; s < surfaces.surfaces.size(); ++s)
    tree.clusters[0].surfaces.emplace_back(s);
  return tree;
}

MultiresNodes build_multires_nodes(const Scene& scene, const Geometry& geometry,
                                   const Surfaces& surfaces, const ClusterTree& clusters) {
  return MultiresBuilder(scene, geometry, surfaces, clusters).build();
}

}  // namespace halflight
