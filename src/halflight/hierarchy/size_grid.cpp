#include "halflight/hierarchy/size_grid.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "halflight/base/morton.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr int kFinestLevel = 20;
constexpr std::size_t kChunk = 32;  // objects agglomerated at once
constexpr std::size_t kItemsAtOnce = 4096;
constexpr float kPadding = 0.02f;  // of the voxel: flat boxes get a volume

struct Item {
  Bounds3f box;
  std::uint32_t index = 0;  // of a surface or of a cluster
  bool is_cluster = false;
};

// Where clusters are made: the tree, or for some voxels of a level by themselves a part of what is
// to be its end.
struct Workplace {
  std::vector<ClusterTree::Cluster>& clusters;
  std::uint32_t first;        // number of clusters.front()
  std::uint32_t level_first;  // of the clusters of this level, which may still take members
  std::uint64_t steps = 0;    // pairs of boxes looked at
};

class Builder {
 public:
  Builder(std::span<const Bounds3f> boxes, const SizeGridOptions& options)
      : boxes_(boxes), options_(options) {
    for (const Bounds3f& box : boxes) scene_.extend(box);
    side_ = std::max(scene_.longest_side(), 1e-20f);
  }

  ClusterTree build(std::uint64_t* steps) {
    std::vector<std::vector<Item>> native(kFinestLevel + 1);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
      native[level_of(boxes_[i])].push_back({boxes_[i], i, false});
    std::vector<Item> promoted;
    for (int level = kFinestLevel; level >= 1; --level) {
      std::vector<Item> items = std::move(native[level]);
      items.insert(items.end(), promoted.begin(), promoted.end());
      promoted = group_level(level, std::move(items));
    }
    promoted.insert(promoted.end(), native[0].begin(), native[0].end());
    Workplace at = in_tree();
    tree_.root = make_cluster(at, promoted);
    if (steps) *steps += steps_;
    return std::move(tree_);
  }

 private:
  // The level whose voxel the box fits: 2^level voxels along each axis of the scene's cube.
  int level_of(const Bounds3f& box) const {
    const float size = box.longest_side();
    if (size <= 0.f) return kFinestLevel;
    return std::clamp(static_cast<int>(std::floor(std::log2(side_ / size))), 0, kFinestLevel);
  }

  std::array<std::uint32_t, 3> voxel_of(const Vec3& p, int level) const {
    const float scale = static_cast<float>(1u << level) / side_;
    const float last = static_cast<float>((1u << level) - 1);
    const Vec3 v = glm::clamp((p - scene_.lower) * scale, Vec3(0.f), Vec3(last));
    return {static_cast<std::uint32_t>(v.x), static_cast<std::uint32_t>(v.y),
            static_cast<std::uint32_t>(v.z)};
  }
  static std::uint64_t key_of(const std::array<std::uint32_t, 3>& voxel) {
    return spread_bits_by_3(voxel[0]) | spread_bits_by_3(voxel[1]) << 1 |
           spread_bits_by_3(voxel[2]) << 2;
  }

  float padded_volume(const Bounds3f& box) const {
    const Vec3 e = box.extent() + Vec3(padding_);
    return e.x * e.y * e.z;
  }
  float empty_share(Workplace& at, const Bounds3f& a, const Bounds3f& b) const {
    ++at.steps;
    Bounds3f both = a;
    both.extend(b);
    return std::max(0.f, 1.f - (padded_volume(a) + padded_volume(b)) / padded_volume(both));
  }

  Workplace in_tree() {
    return {tree_.clusters, 0, static_cast<std::uint32_t>(tree_.clusters.size())};
  }

  // One grid of the stack: returns what is handed to the level above.
  std::vector<Item> group_level(int level, std::vector<Item> items) {
    if (items.empty()) return items;
    const float voxel = side_ / static_cast<float>(1u << level);
    padding_ = kPadding * voxel;
    Workplace at = in_tree();

    std::vector<Item> straddlers;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> inside;  // voxel key, item
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const auto low = voxel_of(items[i].box.lower, level),
                 high = voxel_of(items[i].box.upper, level);
      if (options_.strict && low != high)
        straddlers.push_back(items[i]);
      else
        inside.emplace_back(key_of(voxel_of(items[i].box.center(), level)), i);
    }
    std::stable_sort(inside.begin(), inside.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });

    std::vector<Item> result;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> clusters_in_voxel;
    for (const auto& [key, item] : group_voxels(items, inside, voxel)) {
      if (options_.strict && item.is_cluster)
        clusters_in_voxel[key].push_back(static_cast<std::uint32_t>(result.size()));
      result.push_back(item);
    }
    for (const Item& straddler : straddlers)
      if (!join_touched_cluster(at, straddler, level, clusters_in_voxel, result))
        result.push_back(straddler);
    steps_ += at.steps;
    return result;
  }

  using Keyed = std::pair<std::uint64_t, std::uint32_t>;  // voxel key, item

  // What comes of all voxels, in their order. Blocks of them make their clusters by themselves,
  // numbered as if they were the first, and move up behind each other at the end.
  std::vector<std::pair<std::uint64_t, Item>> group_voxels(const std::vector<Item>& items,
                                                           const std::vector<Keyed>& inside,
                                                           float voxel) {
    std::vector<std::size_t> starts;  // of blocks, where a voxel begins
    for (std::size_t i = 0; i < inside.size(); ++i)
      if ((starts.empty() || i - starts.back() >= kItemsAtOnce) &&
          (i == 0 || inside[i].first != inside[i - 1].first))
        starts.push_back(i);
    starts.push_back(inside.size());
    struct Block {
      std::vector<ClusterTree::Cluster> clusters;
      std::vector<std::pair<std::uint64_t, Item>> result;
      std::uint64_t steps = 0;
    };
    const auto first = static_cast<std::uint32_t>(tree_.clusters.size());
    std::vector<Block> blocks(starts.size() - 1);
    parallel_for(blocks.size(), 1, [&](std::size_t b) {
      Workplace at{blocks[b].clusters, first, first};
      for (std::size_t i = starts[b]; i < starts[b + 1];) {
        const std::uint64_t key = inside[i].first;
        std::vector<Item> held;
        for (; i < starts[b + 1] && inside[i].first == key; ++i)
          held.push_back(items[inside[i].second]);
        for (const Item& item : group_voxel(at, std::move(held), voxel))
          blocks[b].result.emplace_back(key, item);
      }
      blocks[b].steps = at.steps;
    });
    std::vector<std::pair<std::uint64_t, Item>> result;
    for (Block& block : blocks) {
      const auto by = static_cast<std::uint32_t>(tree_.clusters.size()) - first;
      const auto move_up = [&](std::uint32_t& cluster) {
        if (cluster >= first) cluster += by;
      };
      for (ClusterTree::Cluster& cluster : block.clusters) {
        std::for_each(cluster.clusters.begin(), cluster.clusters.end(), move_up);
        tree_.clusters.push_back(std::move(cluster));
      }
      for (auto& [key, item] : block.result) {
        if (item.is_cluster) move_up(item.index);
        result.emplace_back(key, item);
      }
      steps_ += block.steps;
    }
    return result;
  }

  // Objects of one voxel: least empty space first; tiny ones join a cluster even if it is largely
  // empty.
  std::vector<Item> group_voxel(Workplace& at, std::vector<Item> held, float voxel) const {
    const auto tiny_begin = std::stable_partition(held.begin(), held.end(), [&](const Item& item) {
      return item.box.longest_side() >= options_.tiny_share * voxel;
    });
    std::vector<Item> tiny(tiny_begin, held.end());
    held.erase(tiny_begin, held.end());

    sort_by_morton(held);
    std::vector<Item> result;
    for (std::size_t first = 0; first < held.size(); first += kChunk) {
      const std::size_t last = std::min(held.size(), first + kChunk);
      agglomerate(at,
                  {held.begin() + static_cast<std::ptrdiff_t>(first),
                   held.begin() + static_cast<std::ptrdiff_t>(last)},
                  result);
    }
    place_tiny(at, tiny, result);
    return result;
  }

  void place_tiny(Workplace& work, const std::vector<Item>& tiny, std::vector<Item>& result) const {
    std::vector<std::uint32_t> hosts;
    for (std::uint32_t i = 0; i < result.size(); ++i)
      if (result[i].is_cluster) hosts.push_back(i);
    if (hosts.empty()) {
      if (tiny.size() == 1) result.push_back(tiny.front());
      if (tiny.size() > 1) result.push_back(cluster_item(work, tiny));
      return;
    }
    // In a crowd only hosts near along the curve are looked at.
    std::vector<std::uint64_t> codes;
    for (const std::uint32_t host : hosts)
      codes.push_back(morton_code(result[host].box.center(), scene_));
    if (hosts.size() > kChunk) sort_together(codes, hosts);
    std::map<std::uint32_t, std::vector<Item>> guests;
    for (const Item& item : tiny) {
      std::size_t first = 0, last = hosts.size();
      if (last > kChunk) {
        const auto at =
            std::lower_bound(codes.begin(), codes.end(), morton_code(item.box.center(), scene_));
        const auto middle = static_cast<std::size_t>(at - codes.begin());
        first = middle > kChunk / 2 ? middle - kChunk / 2 : 0;
        last = std::min(last, middle + kChunk / 2);
      }
      std::uint32_t best = hosts[first];
      float least = kInfinity;
      for (std::size_t i = first; i < last; ++i) {
        ++work.steps;
        Bounds3f both = result[hosts[i]].box;
        both.extend(item.box);
        const float growth = padded_volume(both) - padded_volume(result[hosts[i]].box);
        if (!(growth < least)) continue;
        least = growth;
        best = hosts[i];
      }
      guests[best].push_back(item);
    }
    for (const auto& [host, joined] : guests) {
      std::vector<Item> members{result[host]};
      members.insert(members.end(), joined.begin(), joined.end());
      result[host] = cluster_item(work, members);
    }
  }

  // Repeatedly merges the pair with the least empty share until none is below the limit.
  void agglomerate(Workplace& at, std::vector<Item> items, std::vector<Item>& result) const {
    struct Best {
      float share = kInfinity;
      std::size_t partner = 0;
    };
    std::vector<Best> best(items.size());
    const auto search = [&](std::size_t i) {
      best[i] = {};
      for (std::size_t j = 0; j < items.size(); ++j) {
        if (j == i) continue;
        const float e = empty_share(at, items[i].box, items[j].box);
        if (e < best[i].share) best[i] = {e, j};
      }
    };
    for (std::size_t i = 0; i < items.size(); ++i) search(i);
    while (items.size() > 1) {
      std::size_t a = 0;
      for (std::size_t i = 1; i < items.size(); ++i)
        if (best[i].share < best[a].share) a = i;
      if (best[a].share > options_.largest_empty_share) break;
      std::size_t b = best[a].partner;
      if (b < a) std::swap(a, b);
      items[a] = merge(at, items[a], items[b]);
      const std::size_t moved = items.size() - 1;
      items[b] = items[moved];
      best[b] = best[moved];
      items.pop_back();
      best.pop_back();
      for (std::size_t i = 0; i < items.size(); ++i) {
        const std::size_t partner = best[i].partner;
        if (i == a || partner == a || partner == b || partner == moved)
          search(i);
        else if (const float e = empty_share(at, items[i].box, items[a].box); e < best[i].share)
          best[i] = {e, a};
      }
    }
    result.insert(result.end(), items.begin(), items.end());
  }

  // Joins a cluster of this level while its fan-out allows, else makes a binary cluster.
  Item merge(Workplace& at, const Item& a, const Item& b) const {
    for (const auto& [host, guest] : {std::pair(a, b), std::pair(b, a)}) {
      if (!host.is_cluster || host.index < at.level_first) continue;
      ClusterTree::Cluster& cluster = at.clusters[host.index - at.first];
      if (cluster.clusters.size() + cluster.surfaces.size() >=
          static_cast<std::size_t>(options_.largest_fan_out))
        continue;
      add_member(cluster, guest);
      Item grown = host;
      grown.box.extend(guest.box);
      return grown;
    }
    return cluster_item(at, {a, b});
  }

  bool join_touched_cluster(
      Workplace& at, const Item& straddler, int level,
      const std::unordered_map<std::uint64_t, std::vector<std::uint32_t>>& clusters_in_voxel,
      std::vector<Item>& result) {
    const auto low = voxel_of(straddler.box.lower, level),
               high = voxel_of(straddler.box.upper, level);
    float least = options_.largest_empty_share;
    Item* host = nullptr;
    for (std::uint32_t z = low[2]; z <= high[2]; ++z)
      for (std::uint32_t y = low[1]; y <= high[1]; ++y)
        for (std::uint32_t x = low[0]; x <= high[0]; ++x) {
          const auto found = clusters_in_voxel.find(key_of({x, y, z}));
          if (found == clusters_in_voxel.end()) continue;
          for (const std::uint32_t i : found->second)
            if (const float e = empty_share(at, result[i].box, straddler.box); e < least) {
              least = e;
              host = &result[i];
            }
        }
    if (!host) return false;
    *host = merge(at, *host, straddler);
    return true;
  }

  static void sort_together(std::vector<std::uint64_t>& codes, std::vector<std::uint32_t>& hosts) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> both;
    for (std::size_t i = 0; i < hosts.size(); ++i) both.emplace_back(codes[i], hosts[i]);
    std::sort(both.begin(), both.end());
    for (std::size_t i = 0; i < hosts.size(); ++i) std::tie(codes[i], hosts[i]) = both[i];
  }

  void sort_by_morton(std::vector<Item>& items) const {
    std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
      return morton_code(a.box.center(), scene_) < morton_code(b.box.center(), scene_);
    });
  }

  static void add_member(ClusterTree::Cluster& cluster, const Item& item) {
    if (item.is_cluster)
      cluster.clusters.push_back(item.index);
    else
      cluster.surfaces.push_back(SurfaceId(item.index));
  }

  Item cluster_item(Workplace& at, const std::vector<Item>& members) const {
    Item item;
    for (const Item& member : members) item.box.extend(member.box);
    item.index = make_cluster(at, members);
    item.is_cluster = true;
    return item;
  }

  // A cluster of any number of members: more than the fan-out are first grouped in Morton order.
  std::uint32_t make_cluster(Workplace& at, std::vector<Item> members) const {
    const auto fan_out = static_cast<std::size_t>(options_.largest_fan_out);
    if (members.size() > fan_out) {
      sort_by_morton(members);
      std::vector<Item> groups;
      for (std::size_t part = 0; part < fan_out; ++part) {
        const std::size_t first = part * members.size() / fan_out;
        const std::size_t last = (part + 1) * members.size() / fan_out;
        if (last - first == 1)
          groups.push_back(members[first]);
        else
          groups.push_back(cluster_item(at, {members.begin() + static_cast<std::ptrdiff_t>(first),
                                             members.begin() + static_cast<std::ptrdiff_t>(last)}));
      }
      members = std::move(groups);
    }
    ClusterTree::Cluster cluster;
    for (const Item& member : members) add_member(cluster, member);
    at.clusters.push_back(std::move(cluster));
    return at.first + static_cast<std::uint32_t>(at.clusters.size() - 1);
  }

  std::span<const Bounds3f> boxes_;
  SizeGridOptions options_;
  Bounds3f scene_;
  float side_ = 1.f;
  float padding_ = 0.f;
  std::uint64_t steps_ = 0;  // pairs of boxes looked at
  ClusterTree tree_;
};

}  // namespace

ClusterTree build_size_grid(std::span<const Bounds3f> surface_boxes, const SizeGridOptions& options,
                            std::uint64_t* steps) {
  return Builder(surface_boxes, options).build(steps);
}

}  // namespace halflight
