// The stack of size grids: what every cluster tree must be, for any set of boxes.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "halflight/base/hash.h"
#include "halflight/hierarchy/size_grid.h"

namespace halflight {
namespace {

struct Case {
  const char* name;
  std::size_t count;
  float smallest, largest;  // sides of the boxes, in a scene of 1 m
  bool strict;
};

std::vector<Bounds3f> random_boxes(const Case& c) {
  std::vector<Bounds3f> boxes(c.count);
  for (std::size_t i = 0; i < c.count; ++i) {
    const auto random = [&](int k) { return to_unit_float(hash(i, k, 77)); };
    const float side = c.smallest * std::pow(c.largest / c.smallest, random(0));
    const Vec3 at(random(1), random(2), random(3));
    // Thin along one axis: surfaces are flat.
    Vec3 extent(side);
    extent[static_cast<int>(3.f * random(4))] = 0.f;
    boxes[i] = {at, at + extent};
  }
  return boxes;
}

class SizeGrid : public ::testing::TestWithParam<Case> {
 protected:
  SizeGrid() : boxes_(random_boxes(GetParam())) {
    options_.strict = GetParam().strict;
    tree_ = build_size_grid(boxes_, options_);
  }

  std::vector<Bounds3f> boxes_;
  SizeGridOptions options_;
  ClusterTree tree_;
};

TEST_P(SizeGrid, HoldsEverySurfaceInExactlyOneCluster) {
  std::vector<int> times(boxes_.size(), 0);
  for (const auto& cluster : tree_.clusters)
    for (const SurfaceId s : cluster.surfaces) ++times.at(s.value);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], 1) << "surface " << i;
}

TEST_P(SizeGrid, IsOneTreeUnderItsRoot) {
  std::vector<int> reached(tree_.clusters.size(), 0);
  std::vector<std::uint32_t> open{tree_.root};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    ASSERT_EQ(reached.at(at)++, 0) << "cluster " << at << " has two parents";
    for (const std::uint32_t child : tree_.clusters[at].clusters) open.push_back(child);
  }
  for (std::size_t i = 0; i < reached.size(); ++i) EXPECT_EQ(reached[i], 1) << "cluster " << i;
}

TEST_P(SizeGrid, KeepsTheFanOutAndMakesNoClusterOfOne) {
  for (std::size_t i = 0; i < tree_.clusters.size(); ++i) {
    const auto& cluster = tree_.clusters[i];
    const std::size_t members = cluster.clusters.size() + cluster.surfaces.size();
    EXPECT_LE(members, static_cast<std::size_t>(options_.largest_fan_out)) << "cluster " << i;
    if (i != tree_.root) {
      EXPECT_GE(members, 2u) << "cluster " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Boxes, SizeGrid,
                         ::testing::Values(Case{"LooseOfAllSizes", 3000, 1e-4f, 1.f, false},
                                           Case{"StrictOfAllSizes", 3000, 1e-4f, 1.f, true},
                                           Case{"LooseOfOneSize", 1000, 0.02f, 0.02f, false},
                                           Case{"StrictOfOneSize", 1000, 0.02f, 0.02f, true},
                                           Case{"LooseCrowd", 2000, 1e-3f, 2e-3f, false},
                                           Case{"StrictCrowd", 2000, 1e-3f, 2e-3f, true},
                                           Case{"LooseSingle", 1, 0.5f, 0.5f, false},
                                           Case{"StrictPair", 2, 0.5f, 0.5f, true}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(SizeGridTest, TakesNoBoxesAndBoxesAllInOnePlace) {
  EXPECT_EQ(build_size_grid({}).clusters.size(), 1u);
  for (const bool strict : {false, true}) {
    SizeGridOptions options;
    options.strict = strict;
    const std::vector<Bounds3f> same(100, Bounds3f{Vec3(0.25f), Vec3(0.25f)});
    std::size_t held = 0;
    for (const auto& cluster : build_size_grid(same, options).clusters)
      held += cluster.surfaces.size();
    EXPECT_EQ(held, 100u);
  }
}

Bounds3f box_of(const ClusterTree& tree, std::uint32_t cluster,
                const std::vector<Bounds3f>& boxes) {
  Bounds3f box;
  for (const SurfaceId s : tree.clusters[cluster].surfaces) box.extend(boxes[s.value]);
  for (const std::uint32_t c : tree.clusters[cluster].clusters) box.extend(box_of(tree, c, boxes));
  return box;
}

// Section 4.1: what is near and of one size comes together before what is far away.
TEST(SizeGridTest, GroupsTwoHeapsOfThingsApart) {
  std::vector<Bounds3f> boxes;
  for (int i = 0; i < 64; ++i) {
    const Vec3 at(0.01f * static_cast<float>(i % 4), 0.01f * static_cast<float>(i / 4 % 4),
                  0.01f * static_cast<float>(i / 16));
    const Vec3 heap = Vec3(0.1f);
    boxes.push_back({heap + at, heap + at + 0.009f});
    boxes.push_back({heap + at + Vec3(0.7f), heap + at + Vec3(0.709f)});
  }
  const ClusterTree tree = build_size_grid(boxes);
  for (std::uint32_t i = 0; i < tree.clusters.size(); ++i) {
    if (i == tree.root) continue;
    EXPECT_LT(box_of(tree, i, boxes).longest_side(), 0.1f) << "cluster " << i << " spans both";
  }
}

}  // namespace
}  // namespace halflight
