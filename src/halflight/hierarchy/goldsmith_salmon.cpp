#include "halflight/hierarchy/goldsmith_salmon.h"

#include <array>
#include <numeric>
#include <utility>

#include "halflight/base/hash.h"
#include "halflight/hierarchy/fan_out.h"

namespace halflight {
namespace {

constexpr std::size_t kFanOut = 8;
constexpr std::uint32_t kIsSurface = 1u << 31;

// A member with all that a decision above it needs.
struct GsMember {
  Bounds3f box;
  std::uint32_t index = 0;   // of a node, or of a surface with kIsSurface
  std::uint32_t weight = 1;  // surfaces below

  bool is_surface() const { return (index & kIsSurface) != 0; }
};

struct GsNode {
  std::array<GsMember, kFanOut> members;
  std::uint32_t count = 0;
  std::uint32_t overflow = 0;  // surfaces attached because the tree is too deep, as a list
};

Bounds3f united(Bounds3f a, const Bounds3f& b) {
  a.extend(b);
  return a;
}

class GoldsmithSalmonBuilder {
 public:
  GoldsmithSalmonBuilder(std::span<const Bounds3f> boxes, const GoldsmithSalmonOptions& options)
      : boxes_(boxes), options_(options), nodes_(1) {}

  ClusterTree build(std::uint64_t* steps) {
    for (const std::uint32_t surface : shuffled()) insert(surface);
    if (steps) *steps += steps_;
    return clusters();
  }

 private:
  // The tree depends on the order; a shuffled one keeps it shallow (section "order" of the paper).
  std::vector<std::uint32_t> shuffled() const {
    std::vector<std::uint32_t> order(boxes_.size());
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[hash(i) % i]);
    return order;
  }

  void insert(std::uint32_t surface) {
    const Bounds3f& box = boxes_[surface];
    Bounds3f around = united(root_box_, box);
    root_box_ = around;
    std::uint32_t at = 0;
    for (int depth = 0;; ++depth) {
      if (depth == options_.deepest) {
        overflow_.emplace_back(SurfaceId(surface), nodes_[at].overflow);
        nodes_[at].overflow = static_cast<std::uint32_t>(overflow_.size());
        return;
      }
      const std::uint32_t chosen = choose(nodes_[at], box, around.surface_area());
      if (chosen == nodes_[at].count) {
        nodes_[at].members[chosen] = {box, surface | kIsSurface, 1};
        ++nodes_[at].count;
        return;
      }
      GsMember& member = nodes_[at].members[chosen];
      const GsMember before = member;
      member.box.extend(box);
      around = member.box;
      ++member.weight;
      if (before.is_surface()) {
        member.index = static_cast<std::uint32_t>(nodes_.size());
        GsNode pair;
        pair.members[0] = before;
        pair.members[1] = {box, surface | kIsSurface, 1};
        pair.count = 2;
        nodes_.push_back(pair);
        return;
      }
      at = before.index;
    }
  }

  // The member to join, or the place of a new one. Rays that meet the node in proportion to its
  // surface area S test each of its members:
  //   a new member costs S; a pair with surface m costs 2 S(m u box);
  //   descending into node m of k members costs k (S(m u box) - S(m)), and below at most as a new
  //   member there, S(m u box), or as a pair when it is full.
  std::uint32_t choose(const GsNode& node, const Bounds3f& box, float area) {
    steps_ += node.count;
    std::uint32_t best = node.count;
    float least = node.count < kFanOut ? area : kInfinity;
    std::uint32_t weight = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const GsMember& m = node.members[i];
      const float joined = united(m.box, box).surface_area();
      float cost = 2.f * joined;
      if (!m.is_surface()) {
        const auto k = static_cast<float>(nodes_[m.index].count);
        const float below = nodes_[m.index].count < kFanOut ? joined : 2.f * joined;
        cost = k * (joined - m.box.surface_area()) + below;
      }
      // Of equal ones the lightest, so that equal boxes make a balanced tree. A full node takes
      // the first where costs are not finite.
      const bool tied = cost == least && best < node.count && m.weight < weight;
      if (!(cost < least || tied || best == kFanOut)) continue;
      best = i;
      least = cost;
      weight = m.weight;
    }
    return best;
  }

  ClusterTree clusters() const {
    ClusterTree tree;
    tree.clusters.resize(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      ClusterTree::Cluster& cluster = tree.clusters[n];
      for (std::uint32_t i = 0; i < nodes_[n].count; ++i) {
        const GsMember& m = nodes_[n].members[i];
        if (m.is_surface())
          cluster.surfaces.emplace_back(m.index & ~kIsSurface);
        else
          cluster.clusters.push_back(m.index);
      }
      for (std::uint32_t o = nodes_[n].overflow; o != 0; o = overflow_[o - 1].second)
        cluster.surfaces.push_back(overflow_[o - 1].first);
    }
    limit_fan_out(tree, boxes_, kFanOut);
    return tree;
  }

  std::span<const Bounds3f> boxes_;
  GoldsmithSalmonOptions options_;
  std::vector<GsNode> nodes_;
  std::vector<std::pair<SurfaceId, std::uint32_t>> overflow_;  // surface, next of the list
  Bounds3f root_box_;
  std::uint64_t steps_ = 0;
};

}  // namespace

ClusterTree build_goldsmith_salmon(std::span<const Bounds3f> boxes,
                                   const GoldsmithSalmonOptions& options, std::uint64_t* steps) {
  return GoldsmithSalmonBuilder(boxes, options).build(steps);
}

}  // namespace halflight
