// The measures of a hierarchy on scenes whose answers are known.
#include <gtest/gtest.h>

#include "clustered_world.h"
#include "halflight/visibility/hierarchy_measures.h"

namespace halflight {
namespace {

using testing::Dice;
using testing::ShapeScene;

// A thousand small discs spread evenly through one cluster of 1 m: the medium that extinction is
// exact for.
TEST(HierarchyMeasures, FindNoBiasWhereAMediumIsExact) {
  ShapeScene shapes;
  Dice dice(1);
  for (int i = 0; i < 1500; ++i) shapes.disc(dice.point(), dice.frame(), 0.02f, 8);
  const auto world = testing::cluster(shapes);
  ClusterTree one;
  one.clusters.resize(1);
  for (std::size_t s = 0; s < world.surfaces.surfaces.size(); ++s)
    one.clusters[0].surfaces.emplace_back(s);
  const HierarchyMeasures m = measure_hierarchy(world.world, world.surfaces, one);
  EXPECT_EQ(m.clusters, 1u);
  EXPECT_EQ(m.depth, 1);
  EXPECT_EQ(m.extinction[0].clusters, 1u);
  EXPECT_LT(std::abs(m.extinction[0].bias), 0.08);  // 128 lines
  EXPECT_EQ(m.exact.rms, 0.0);
  EXPECT_GT(m.exact.nodes, 1.0);
}

// Two boxes of 1 m at the ends of one of 10 m leave four fifths of it empty.
TEST(HierarchyMeasures, CountEmptySpaceMembersAndSizes) {
  ShapeScene shapes;
  const Frame upright = Frame::from_normal({0.f, 0.f, 1.f});
  shapes.cube({0.5f, 0.5f, 0.5f}, upright, 1.f);
  shapes.cube({9.5f, 0.5f, 0.5f}, upright, 1.f);
  const auto world = testing::cluster(shapes);
  ASSERT_EQ(world.surfaces.surfaces.size(), 12u);
  ClusterTree tree;
  tree.clusters.resize(3);
  tree.clusters[0].clusters = {1, 2};
  for (std::size_t s = 0; s < 12; ++s) {
    const bool far = world.surfaces[SurfaceId(s)].box.center().x > 5.f;
    tree.clusters[far ? 2 : 1].surfaces.emplace_back(s);
  }
  const HierarchyMeasures m = measure_hierarchy(world.world, world.surfaces, tree);
  EXPECT_EQ(m.depth, 2);
  EXPECT_EQ(m.largest_fan_out, 6u);
  EXPECT_NEAR(m.fan_out, 14.0 / 3.0, 1e-9);
  EXPECT_NEAR(m.size_spread, 0.0, 1e-6);
  // Of the root 0.8 less what a fiftieth of its length adds to the parts; sides are flat in theirs.
  EXPECT_GT(m.empty_space, 0.6);
  EXPECT_LT(m.empty_space, 0.95);
  EXPECT_EQ(m.extinction[0].clusters, 1u);
  EXPECT_EQ(m.extinction[1].clusters, 2u);
  // A closed cube stops every line; as a medium it lets a good part through.
  EXPECT_GT(m.extinction[1].bias, 0.2);
}

TEST(HierarchyMeasures, TakeAnEmptyScene) {
  const World world{Scene()};
  ClusterTree tree;
  tree.clusters.resize(1);
  const HierarchyMeasures m = measure_hierarchy(world, Surfaces(), tree);
  EXPECT_EQ(m.clusters, 1u);
  EXPECT_EQ(m.exact.nodes, 0.0);
}

}  // namespace
}  // namespace halflight
