// What every builder must make of any set of surfaces: one tree, each surface in one cluster, the
// same for any number of threads, with work that grows no faster than n log n.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "halflight/base/hash.h"
#include "halflight/base/morton_order.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/agglomerative.h"
#include "halflight/hierarchy/build_hierarchy.h"
#include "halflight/hierarchy/goldsmith_salmon.h"
#include "halflight/hierarchy/kd_tree.h"
#include "halflight/hierarchy/size_grid.h"

namespace halflight {
namespace {

// Flat boxes of all sizes in a unit cube, three to an object on the mean.
std::vector<SurfaceShape> random_shapes(std::size_t count, std::uint64_t seed) {
  std::vector<SurfaceShape> shapes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto random = [&](int k) { return to_unit_float(hash(seed, i, k)); };
    const float side = 1e-3f * std::pow(200.f, random(0));
    const int axis = static_cast<int>(3.f * random(4));
    SurfaceShape& s = shapes[i];
    const Vec3 at(random(1), random(2), random(3));
    Vec3 extent(side);
    extent[axis] = 0.f;
    s.box = {at, at + extent};
    s.normal[axis] = random(5) < 0.5f ? -1.f : 1.f;
    s.area = side * side;
    s.object = static_cast<std::uint32_t>(hash(seed, i, 6) % (count / 3 + 1));
  }
  return shapes;
}

std::vector<Bounds3f> boxes_of(std::span<const SurfaceShape> shapes) {
  std::vector<Bounds3f> boxes;
  for (const SurfaceShape& s : shapes) boxes.push_back(s.box);
  return boxes;
}

// The kinds with their defaults, and forms that only options reach.
struct Builder {
  const char* name;
  ClusterTree (*build)(std::span<const SurfaceShape>, std::uint64_t* steps);
  std::size_t largest_fan_out = 8;  // 0: any
};
const std::vector<Builder> kBuilders{
    {"SizeGrid", [](std::span<const SurfaceShape> s,
                    std::uint64_t* n) { return build_hierarchy(HierarchyKind::size_grid, s, n); }},
    {"StrictSizeGrid",
     [](std::span<const SurfaceShape> s, std::uint64_t* n) {
       SizeGridOptions options;
       options.strict = true;
       return build_size_grid(boxes_of(s), options, n);
     }},
    {"KdTree", [](std::span<const SurfaceShape> s,
                  std::uint64_t* n) { return build_hierarchy(HierarchyKind::kd_tree, s, n); }},
    {"KdTreeOfWholeCells",
     [](std::span<const SurfaceShape> s, std::uint64_t* n) {
       KdTreeOptions options;
       options.whole_cells = true;
       return build_kd_tree(boxes_of(s), options, n);
     },
     0},
    {"GoldsmithSalmon",
     [](std::span<const SurfaceShape> s, std::uint64_t* n) {
       return build_hierarchy(HierarchyKind::goldsmith_salmon, s, n);
     }},
    {"Agglomerative",
     [](std::span<const SurfaceShape> s, std::uint64_t* n) {
       return build_hierarchy(HierarchyKind::agglomerative, s, n);
     }},
    {"AgglomerativeWithoutObjects", [](std::span<const SurfaceShape> s, std::uint64_t* n) {
       AgglomerativeOptions options;
       options.largest_object = 0.f;
       options.search_radius = 2;
       return build_agglomerative(s, options, n);
     }}};

class HierarchyBuilders : public ::testing::TestWithParam<Builder> {
 protected:
  static ClusterTree build(std::span<const SurfaceShape> shapes, std::uint64_t* steps = nullptr) {
    return GetParam().build(shapes, steps);
  }
  static void expect_valid(std::span<const SurfaceShape> shapes, const char* what) {
    SCOPED_TRACE(what);
    const ClusterTree tree = build(shapes);
    std::vector<int> held(shapes.size(), 0), reached(tree.clusters.size(), 0);
    std::vector<std::uint32_t> open{tree.root};
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      ASSERT_EQ(reached.at(at)++, 0) << "cluster " << at << " has two parents";
      const ClusterTree::Cluster& cluster = tree.clusters[at];
      for (const std::uint32_t child : cluster.clusters) open.push_back(child);
      for (const SurfaceId s : cluster.surfaces) ++held.at(s.value);
      const std::size_t members = cluster.clusters.size() + cluster.surfaces.size();
      if (GetParam().largest_fan_out > 0) {
        EXPECT_LE(members, GetParam().largest_fan_out);
      }
      if (at != tree.root) {
        EXPECT_GE(members, 2u) << "cluster " << at << " groups nothing";
      }
    }
    for (std::size_t i = 0; i < reached.size(); ++i) EXPECT_EQ(reached[i], 1) << "cluster " << i;
    for (std::size_t i = 0; i < held.size(); ++i) EXPECT_EQ(held[i], 1) << "surface " << i;
  }
};

INSTANTIATE_TEST_SUITE_P(Of, HierarchyBuilders, ::testing::ValuesIn(kBuilders),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(HierarchyBuilders, HoldEverySurfaceOnceInOneTree) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    for (const std::size_t n : {2u, 9u, 100u, 5000u})
      expect_valid(random_shapes(n, seed), "random boxes");
}

TEST_P(HierarchyBuilders, TakeDegenerateInput) {
  expect_valid({}, "none");
  expect_valid(random_shapes(1, 1), "one");
  std::vector<SurfaceShape> shapes(3000, random_shapes(1, 2).front());
  expect_valid(shapes, "all equal, one object");
  for (std::uint32_t i = 0; i < shapes.size(); ++i) shapes[i].object = i;
  expect_valid(shapes, "all equal");
  for (SurfaceShape& s : shapes) s.box.upper = s.box.lower;
  expect_valid(shapes, "points in one place");
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Vec3 at(0.5f * static_cast<float>(i) * static_cast<float>(i), 0.f, 0.f);
    shapes[i].box = {at, at};
  }
  expect_valid(shapes, "on a line, ever farther apart");
  for (std::size_t i = 0; i < shapes.size(); ++i)
    shapes[i].box = {Vec3(0.f), Vec3(static_cast<float>(i + 1))};
  expect_valid(shapes, "one inside the other");
  for (const float scale : {1e18f, 1e37f}) {
    std::vector<SurfaceShape> huge = random_shapes(500, 3);
    for (SurfaceShape& s : huge) {
      s.box = {s.box.lower * scale - 0.5f * scale, s.box.upper * scale - 0.5f * scale};
      s.area *= scale * scale;
    }
    expect_valid(huge, "huge coordinates");
  }
}

bool same(const ClusterTree& a, const ClusterTree& b) {
  if (a.root != b.root || a.clusters.size() != b.clusters.size()) return false;
  for (std::size_t i = 0; i < a.clusters.size(); ++i)
    if (a.clusters[i].clusters != b.clusters[i].clusters ||
        a.clusters[i].surfaces != b.clusters[i].surfaces)
      return false;
  return true;
}

TEST_P(HierarchyBuilders, GiveTheSameTreeForAnyNumberOfThreads) {
  const auto shapes = random_shapes(40000, 4);
  set_thread_count(1);
  const ClusterTree alone = build(shapes);
  set_thread_count(4);
  const ClusterTree together = build(shapes);
  set_thread_count(0);
  EXPECT_TRUE(same(alone, together));
}

double steps_per_n_log_n(ClusterTree (*build)(std::span<const SurfaceShape>, std::uint64_t*),
                         std::span<const SurfaceShape> shapes) {
  std::uint64_t steps = 0;
  build(shapes, &steps);
  const auto n = static_cast<double>(shapes.size());
  return static_cast<double>(steps) / (n * std::log2(n));
}

// Eight times as many: n^1.5 would do 2.4 times the work for each n log n.
TEST_P(HierarchyBuilders, DoWorkThatGrowsNoFasterThanNLogN) {
  const double few = steps_per_n_log_n(GetParam().build, random_shapes(32000, 5));
  EXPECT_GT(few, 0.01);
  EXPECT_LT(steps_per_n_log_n(GetParam().build, random_shapes(256000, 5)), 2.0 * few);
}

// Half of them a tenth of the others' size, all in one place.
TEST_P(HierarchyBuilders, DoNoMoreWorkInACrowd) {
  const auto crowd = [](std::size_t n) {
    std::vector<SurfaceShape> shapes = random_shapes(n, 6);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 at = 0.2f * shapes[i].box.lower;
      shapes[i].box = {at, at + (i % 2 ? 0.1f : 0.01f)};
      shapes[i].object = static_cast<std::uint32_t>(i);
    }
    shapes[0].box = {Vec3(0.f), Vec3(1.f)};
    return shapes;
  };
  EXPECT_LT(steps_per_n_log_n(GetParam().build, crowd(256000)),
            2.0 * steps_per_n_log_n(GetParam().build, crowd(32000)));
}

// Neighbours whose best partner is always the one before would merge one pair a round.
TEST(AgglomerativeTest, DoesLittleWorkOnAChain) {
  std::vector<SurfaceShape> shapes(20000);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double x = static_cast<double>(i) * static_cast<double>(i);
    shapes[i].box = {Vec3(static_cast<float>(x), 0.f, 0.f), Vec3(static_cast<float>(x), 1.f, 1.f)};
    shapes[i].object = static_cast<std::uint32_t>(i);
  }
  std::uint64_t steps = 0;
  build_agglomerative(shapes, {}, &steps);
  EXPECT_LT(steps, 8u * 40u * shapes.size());
}

int depth_of(const ClusterTree& tree, std::uint32_t cluster) {
  int deepest = 0;
  for (const std::uint32_t child : tree.clusters[cluster].clusters)
    deepest = std::max(deepest, depth_of(tree, child));
  return deepest + 1;
}

// Section 4.1: what belongs together comes together first. Two interleaved combs of ten teeth each.
TEST(AgglomerativeTest, KeepsObjectsApartThatInterleave) {
  std::vector<SurfaceShape> shapes(20);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const float x = 0.01f * static_cast<float>(i);
    shapes[i].box = {{x, 0.f, 0.f}, {x + 0.002f, 0.1f, 0.1f}};
    shapes[i].object = i % 2;
  }
  SurfaceShape far;
  far.box = {Vec3(5.f), Vec3(5.1f)};
  far.object = 2;
  shapes.push_back(far);
  const ClusterTree tree = build_agglomerative(shapes);
  for (const ClusterTree::Cluster& cluster : tree.clusters)
    for (const SurfaceId s : cluster.surfaces)
      EXPECT_EQ(shapes[s.value].object, shapes[cluster.surfaces.front().value].object);
}

TEST(GoldsmithSalmonTest, StaysShallowOnEqualBoxes) {
  const std::vector<Bounds3f> same(4096, Bounds3f{Vec3(0.f), Vec3(1.f)});
  const ClusterTree tree = build_goldsmith_salmon(same);
  EXPECT_LE(depth_of(tree, tree.root), 14);
}

// A cut in the middle of 1 m is at 0.5 m: what crosses it stays in the root.
TEST(KdTreeTest, LeavesWhatStraddlesAboveTheCut) {
  std::vector<Bounds3f> boxes;
  for (int i = 0; i < 20; ++i) {
    const float x = 0.05f * static_cast<float>(i);
    boxes.push_back({{x, 0.f, 0.f}, {x + 0.03f, 0.01f, 0.01f}});
  }
  boxes.push_back({{0.f, 0.f, 0.f}, {0.001f, 0.001f, 0.001f}});
  boxes.push_back({{0.999f, 0.f, 0.f}, {1.f, 0.001f, 0.001f}});
  boxes.push_back({{0.499f, 0.f, 0.f}, {0.501f, 0.001f, 0.001f}});  // small, on the cut
  KdTreeOptions options;
  options.whole_cells = true;
  const ClusterTree tree = build_kd_tree(boxes, options);
  EXPECT_EQ(tree.clusters[tree.root].surfaces, std::vector{SurfaceId(22)});
  ASSERT_EQ(tree.volumes.size(), tree.clusters.size());
  EXPECT_FLOAT_EQ(tree.volumes[tree.clusters[tree.root].clusters[0]].upper.x, 0.5f);
  for (std::size_t c = 0; c < tree.clusters.size(); ++c) {
    for (const SurfaceId s : tree.clusters[c].surfaces) {
      EXPECT_TRUE(tree.volumes[c].contains(boxes[s.value].lower));
      EXPECT_TRUE(tree.volumes[c].contains(boxes[s.value].upper));
    }
    for (const std::uint32_t child : tree.clusters[c].clusters) {
      EXPECT_TRUE(tree.volumes[c].contains(tree.volumes[child].lower));
      EXPECT_TRUE(tree.volumes[c].contains(tree.volumes[child].upper));
    }
  }
}

TEST(MortonOrderTest, SortsByKeyAndKeepsTheOrderOfEqualKeys) {
  std::vector<std::uint64_t> keys;
  for (std::uint64_t i = 0; i < 5000; ++i) keys.push_back(hash(i) % 300 << (i % 2 ? 55 : 3));
  std::vector<std::uint32_t> expected(keys.size());
  for (std::uint32_t i = 0; i < expected.size(); ++i) expected[i] = i;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  EXPECT_EQ(order_by_key(keys), expected);
}

TEST(HierarchyKinds, HaveNamesOfTheirOwn) {
  for (const NamedHierarchy& a : kHierarchies) {
    EXPECT_EQ(name_of(a.kind), a.name);
    for (const NamedHierarchy& b : kHierarchies)
      if (a.kind != b.kind) {
        EXPECT_NE(a.name, b.name);
      }
  }
}

}  // namespace
}  // namespace halflight
