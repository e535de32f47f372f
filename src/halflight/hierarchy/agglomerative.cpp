#include "halflight/hierarchy/agglomerative.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "halflight/base/morton_order.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr std::size_t kSlowRound = 16;  // a round that merges fewer than 1 in so many is helped
constexpr std::size_t kSearchGrain = 2048;
constexpr std::size_t kBlock = 1u << 15;  // of the list, when it is compacted

// A cluster in the making. Lengths are in units of the scene's longest side.
struct MergeCandidate {
  Bounds3f box;
  Vec3 normals{0.f};  // sum of area times normal
  float area = 0.f;
  float log_size = 0.f;  // log2 of the longest side
  std::uint32_t node = 0;
  std::uint32_t object = 0;
};

// Nodes 0 to n - 1 are the surfaces, those after are pairs of earlier ones.
struct PairNode {
  std::uint32_t first = 0, second = 0;
  std::uint32_t surfaces = 0;
  float box_area = 0.f;
};

float log_size_of(const Bounds3f& box) { return std::log2(std::max(box.longest_side(), 1e-9f)); }

class AgglomerativeBuilder {
 public:
  AgglomerativeBuilder(std::span<const SurfaceShape> shapes, const AgglomerativeOptions& options)
      : shapes_(shapes), options_(options) {
    for (const SurfaceShape& s : shapes) scene_.extend(s.box);
    scale_ = 1.f / std::max(scene_.longest_side(), 1e-30f);
    radius_ = static_cast<std::size_t>(std::max(1, options.search_radius));
  }

  ClusterTree build(std::uint64_t* steps) {
    if (shapes_.empty()) {
      ClusterTree empty;
      empty.clusters.resize(1);
      return empty;
    }
    pairs_.reserve(shapes_.size());
    start();
    while (!active_.empty()) {
      merge_round();
      retire();
    }
    active_ = std::move(finished_);
    sort_along_curve(active_, [](const MergeCandidate&) { return 0u; });
    for (MergeCandidate& c : active_) c.object = 0;
    while (active_.size() > 1) merge_round();
    if (steps) *steps += steps_;
    return collapse(active_.front().node);
  }

 private:
  void start() {
    const std::size_t n = shapes_.size();
    std::vector<Bounds3f> bodies;
    for (const SurfaceShape& s : shapes_) {
      if (s.object >= bodies.size()) bodies.resize(s.object + std::size_t{1});
      bodies[s.object].extend(s.box);
    }
    active_.resize(n);
    const auto own = static_cast<std::uint32_t>(bodies.size());
    parallel_for(n, 4096, [&](std::size_t i) {
      const SurfaceShape& s = shapes_[i];
      MergeCandidate& c = active_[i];
      c.box = {(s.box.lower - scene_.lower) * scale_, (s.box.upper - scene_.lower) * scale_};
      c.area = s.area * scale_ * scale_;
      c.normals = c.area * s.normal;
      c.log_size = log_size_of(c.box);
      c.node = static_cast<std::uint32_t>(i);
      const bool whole = bodies[s.object].longest_side() * scale_ <= options_.largest_object;
      c.object = whole ? s.object : own + static_cast<std::uint32_t>(i);
    });
    sort_along_curve(active_, [](const MergeCandidate& c) { return c.object; });
    retire();
  }

  template <class Group>
  static void sort_along_curve(std::vector<MergeCandidate>& list, const Group& group) {
    const Bounds3f unit{Vec3(0.f), Vec3(1.f)};
    arrange(list, order_along_curve(list.size(), unit,
                                    [&](std::size_t i) { return list[i].box.center(); }));
    std::vector<std::uint64_t> keys(list.size());
    parallel_for(list.size(), 4096, [&](std::size_t i) { keys[i] = group(list[i]); });
    arrange(list, order_by_key(keys));
  }

  // What is alone in its object waits for the others.
  void retire() {
    const auto alone = [&](std::size_t i) {
      const std::uint32_t object = active_[i].object;
      return !(i > 0 && active_[i - 1].object == object) &&
             !(i + 1 < active_.size() && active_[i + 1].object == object);
    };
    std::vector<MergeCandidate> kept;
    std::size_t waiting = 0;
    for (std::size_t i = 0; i < active_.size(); ++i) waiting += alone(i);
    if (waiting == 0) return;
    kept.reserve(active_.size() - waiting);
    for (std::size_t i = 0; i < active_.size(); ++i)
      (alone(i) ? finished_ : kept).push_back(active_[i]);
    active_ = std::move(kept);
  }

  float merge_cost(const MergeCandidate& a, const MergeCandidate& b) const {
    Bounds3f both = a.box;
    both.extend(b.box);
    const float area = a.area + b.area;
    const float turned = area > 0.f ? 1.f - glm::length(a.normals + b.normals) / area : 0.f;
    return both.surface_area() * (1.f + options_.size_weight * std::abs(a.log_size - b.log_size)) *
           (1.f + options_.orientation_weight * turned);
  }

  // Of pairs of equal cost the one whose places differ in the lowest bits comes first: equal boxes
  // then merge two by two at once. A strict order of all pairs, so that the least of them is chosen
  // from both ends and every round merges something.
  struct Choice {
    float cost = kInfinity;
    std::uint32_t partner = 0;
    bool valid = false;

    void consider(float other_cost, std::size_t self, std::size_t other) {
      const auto o = static_cast<std::uint32_t>(other);
      if (!valid || other_cost < cost ||
          (other_cost == cost && (self ^ other) < (self ^ partner))) {
        cost = other_cost;
        partner = o;
        valid = true;
      }
    }
  };

  void search(std::size_t first, std::size_t last, std::vector<Choice>& choices) const {
    const std::size_t n = active_.size();
    for (std::size_t i = first > radius_ ? first - radius_ : 0; i < last; ++i)
      for (std::size_t j = i + 1; j <= std::min(n - 1, i + radius_); ++j) {
        if (active_[j].object != active_[i].object) break;
        if (i < first && j < first) continue;
        if (i < first && j >= last) break;
        const float cost = merge_cost(active_[i], active_[j]);
        if (i >= first) choices[i].consider(cost, i, j);
        if (j >= first && j < last) choices[j].consider(cost, j, i);
      }
  }

  // Neighbours in pairs, whatever they cost: what a round does that could not find better.
  void pair_up(std::vector<Choice>& choices) const {
    for (std::size_t i = 0; i + 1 < active_.size(); ++i) {
      choices[i].valid = choices[i + 1].valid = false;
      if (active_[i].object != active_[i + 1].object) continue;
      choices[i] = {0.f, static_cast<std::uint32_t>(i + 1), true};
      choices[i + 1] = {0.f, static_cast<std::uint32_t>(i), true};
      ++i;
    }
  }

  static bool mutual(const std::vector<Choice>& choices, std::size_t i) {
    return choices[i].valid && choices[choices[i].partner].valid &&
           choices[choices[i].partner].partner == i;
  }

  void merge_round() {
    const std::size_t n = active_.size();
    std::vector<Choice> choices(n);
    parallel_ranges(n, kSearchGrain,
                    [&](std::size_t first, std::size_t last) { search(first, last, choices); });
    steps_ += static_cast<std::uint64_t>(n) * radius_;
    const std::size_t merging = parallel_sum<std::size_t>(
        n, kBlock, 0, [&](std::size_t i) { return mutual(choices, i) ? 1u : 0u; });
    if (merging * kSlowRound < n) pair_up(choices);
    apply(choices);
  }

  // Merged clusters take the place of their first part.
  void apply(const std::vector<Choice>& choices) {
    const std::size_t n = active_.size(), blocks = (n + kBlock - 1) / kBlock;
    const auto leads = [&](std::size_t i) { return mutual(choices, i) && i < choices[i].partner; };
    const auto gone = [&](std::size_t i) { return mutual(choices, i) && i > choices[i].partner; };
    std::vector<std::size_t> pairs_before(blocks + 1, 0), kept_before(blocks + 1, 0);
    parallel_for(blocks, 1, [&](std::size_t b) {
      for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
        pairs_before[b + 1] += leads(i);
        kept_before[b + 1] += !gone(i);
      }
    });
    std::partial_sum(pairs_before.begin(), pairs_before.end(), pairs_before.begin());
    std::partial_sum(kept_before.begin(), kept_before.end(), kept_before.begin());
    const std::size_t first_pair = pairs_.size();
    pairs_.resize(first_pair + pairs_before.back());
    std::vector<MergeCandidate> merged(kept_before.back());
    parallel_for(blocks, 1, [&](std::size_t b) {
      std::size_t pair = first_pair + pairs_before[b], kept = kept_before[b];
      for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
        if (gone(i)) continue;
        MergeCandidate c = active_[i];
        if (leads(i)) {
          const MergeCandidate& other = active_[choices[i].partner];
          c.box.extend(other.box);
          pairs_[pair] = {c.node, other.node, surfaces_of(c.node) + surfaces_of(other.node),
                          c.box.surface_area()};
          c.normals += other.normals;
          c.area += other.area;
          c.log_size = log_size_of(c.box);
          c.node = static_cast<std::uint32_t>(shapes_.size() + pair++);
        }
        merged[kept++] = c;
      }
    });
    active_ = std::move(merged);
  }

  bool is_pair(std::uint32_t node) const { return node >= shapes_.size(); }
  const PairNode& pair(std::uint32_t node) const { return pairs_[node - shapes_.size()]; }
  std::uint32_t surfaces_of(std::uint32_t node) const {
    return is_pair(node) ? pair(node).surfaces : 1;
  }

  // From pairs to clusters of up to the fan-out: what has no more surfaces than that is one
  // cluster; above, the parts of the largest boxes are opened first.
  ClusterTree collapse(std::uint32_t root) const {
    ClusterTree tree;
    std::vector<std::uint32_t> nodes{root};
    tree.clusters.resize(1);
    for (std::size_t c = 0; c < nodes.size(); ++c) {
      for (const std::uint32_t member : members_of(nodes[c])) {
        if (!is_pair(member)) {
          tree.clusters[c].surfaces.emplace_back(member);
          continue;
        }
        tree.clusters[c].clusters.push_back(static_cast<std::uint32_t>(tree.clusters.size()));
        tree.clusters.emplace_back();
        nodes.push_back(member);
      }
    }
    return tree;
  }

  std::vector<std::uint32_t> members_of(std::uint32_t node) const {
    std::vector<std::uint32_t> members{node};
    const bool last = surfaces_of(node) <= options_.largest_fan_out;
    while (members.size() < options_.largest_fan_out) {
      std::size_t chosen = members.size();
      for (std::size_t i = 0; i < members.size(); ++i) {
        if (!is_pair(members[i])) continue;
        if (!last && pair(members[i]).surfaces <= options_.largest_fan_out) continue;
        if (chosen == members.size() || pair(members[i]).box_area > pair(members[chosen]).box_area)
          chosen = i;
      }
      if (chosen == members.size()) break;
      const PairNode opened = pair(members[chosen]);
      members[chosen] = opened.first;
      members.push_back(opened.second);
    }
    return members;
  }

  std::span<const SurfaceShape> shapes_;
  AgglomerativeOptions options_;
  std::size_t radius_ = 1;
  Bounds3f scene_;
  float scale_ = 1.f;
  std::vector<MergeCandidate> active_, finished_;
  std::vector<PairNode> pairs_;
  std::uint64_t steps_ = 0;
};

}  // namespace

ClusterTree build_agglomerative(std::span<const SurfaceShape> shapes,
                                const AgglomerativeOptions& options, std::uint64_t* steps) {
  return AgglomerativeBuilder(shapes, options).build(steps);
}

}  // namespace halflight
