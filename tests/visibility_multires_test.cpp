// The tree: every surface once, exact where nothing stops, and the criterion where something does.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "clustered_world.h"
#include "halflight/base/parallel.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/visibility/multires_build.h"
#include "halflight/visibility/visibility.h"

namespace halflight {
namespace {

using testing::ClusteredWorld;
using testing::Dice;
using testing::ShapeScene;

MultiresTree make_tree(const ClusteredWorld& c, const MultiresOptions& options = {}) {
  return {c.world.scene, c.world.geometry, c.surfaces, c.clusters, options};
}

void expect_every_triangle_once(const MultiresTree& tree, const Geometry& geometry) {
  std::multiset<TriangleId> held;
  for (const TriangleBlock& block : tree.arrays().blocks)
    for (int i = 0; i < 8; ++i)
      if (block.used >> i & 1) held.insert(block.triangles[i]);
  EXPECT_EQ(held.size(), geometry.triangles.size());
  EXPECT_EQ(std::set<TriangleId>(held.begin(), held.end()).size(), held.size());
}

// Discs and cubes of all sizes in the unit cube; panes of half opacity among them.
ShapeScene clutter(std::uint64_t seed, int n) {
  ShapeScene shapes;
  Dice dice(seed);
  for (int i = 0; i < n; ++i) {
    const Vec3 at = dice.point();
    const float size = 0.2f * std::pow(dice.number(), 4.f) + 0.01f;
    const Frame frame = dice.frame();
    if (i % 3 == 0)
      shapes.cube(at, frame, size);
    else
      shapes.disc(at, frame, size, 3 + i % 7);
  }
  shapes.end_mesh();
  Material pane = shapes.material();
  pane.alpha_mode = AlphaMode::blend;
  pane.alpha = 0.5f;
  const MaterialId half = shapes.scene.materials.push_back(pane);
  MeshParts parts;
  for (int i = 0; i < n / 10; ++i) {
    const Vec3 at = dice.point();
    const Frame f = dice.frame();
    append_triangle(parts[half], at, at + 0.2f * f.tangent, at + 0.2f * f.bitangent);
  }
  if (n >= 10) add_node(shapes.scene, "panes", add_mesh(shapes.scene, "panes", std::move(parts)));
  return shapes;
}

// Any tree a builder may come up with: chains, wide nodes, empty clusters.
ClusterTree random_clusters(std::size_t surfaces, std::uint64_t seed) {
  Dice dice(seed);
  const auto n = 1 + static_cast<std::size_t>(dice.number() * 0.5f * static_cast<float>(surfaces));
  ClusterTree tree;
  tree.clusters.resize(n);
  const bool chain = dice.number() < 0.3f;
  for (std::size_t i = 1; i < n; ++i) {
    const std::size_t parent =
        chain ? i - 1 : static_cast<std::size_t>(dice.number() * static_cast<float>(i));
    tree.clusters[std::min(parent, i - 1)].clusters.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t s = 0; s < surfaces; ++s)
    tree.clusters[std::min(n - 1, static_cast<std::size_t>(dice.number() * static_cast<float>(n)))]
        .surfaces.push_back(SurfaceId(s));
  return tree;
}

class RandomTrees : public ::testing::TestWithParam<int> {
 protected:
  RandomTrees() : shapes_(clutter(static_cast<std::uint64_t>(GetParam()), 20 * GetParam())) {
    world_ = std::make_unique<ClusteredWorld>(shapes_.scene);
    const int kind = GetParam() % 3;
    if (kind == 1)
      world_->clusters = random_clusters(world_->surfaces.surfaces.size(), 7u * GetParam());
    if (kind == 2) world_->clusters = one_cluster(world_->surfaces);
  }
  ShapeScene shapes_;
  std::unique_ptr<ClusteredWorld> world_;
};

TEST_P(RandomTrees, HoldEveryTriangleOnceAndInsideTheBoxesAboveIt) {
  const MultiresTree tree = make_tree(*world_);
  expect_every_triangle_once(tree, world_->world.geometry);
  for (std::size_t slot = 0; slot < tree.arrays().contents.size(); ++slot) {
    const MultiresNode& node = tree.arrays().nodes[slot / 8];
    if (slot % 8 >= node.slot_count) continue;
    const Bounds3f box = node.box_of(static_cast<int>(slot % 8));
    const auto& below = tree.arrays().contents[slot];
    float area = 0.f;
    for (std::uint32_t b = below.first_block; b < below.last_block; ++b)
      for (int i = 0; i < 8; ++i) {
        if (!(tree.arrays().blocks[b].used >> i & 1)) continue;
        const TriangleId t = tree.arrays().blocks[b].triangles[i];
        for (const Vec3& corner : world_->world.geometry.corners(t))
          ASSERT_TRUE(box.contains(corner));
        area += 0.5f * glm::length(world_->world.geometry.scaled_normal(t));
      }
    ASSERT_LE(tree.arrays().blocking_areas[slot], 0.501f * area);
    ASSERT_GE(tree.arrays().blocking_areas[slot], 0.249f * area);
  }
}

// A cut: nothing twice, nothing that the ray meets left out.
TEST_P(RandomTrees, CountEverySurfaceThatARayMeetsOnce) {
  const MultiresTree tree = make_tree(*world_);
  Dice dice(GetParam());
  std::size_t stops = 0, blocks = 0;
  for (int ray = 0; ray < 200; ++ray) {
    const Vec3 from = 1.4f * dice.point() - 0.2f, to = 1.4f * dice.point() - 0.2f;
    const VisibilityRay r{from, to - from, 1.f};
    const StopRule rule = StopRule::between(std::pow(dice.number(), 3.f), 0.5f * dice.number());
    const auto parts = tree.cut(r, rule, ray % 2 == 0);
    std::multiset<TriangleId> counted;
    for (const auto& part : parts) {
      (part.stopped ? stops : blocks) += 1;
      counted.insert(part.triangles.begin(), part.triangles.end());
    }
    ASSERT_EQ(std::set<TriangleId>(counted.begin(), counted.end()).size(), counted.size());
    // All opaque triangles along the ray, found one after another by exact rays.
    for (float past = 0.f; past < 1.f;) {
      const Vec3 start = from + past * (to - from);
      const auto hit = world_->world.rays.closest_hit(start, to - from, 1.f - past, 1);
      if (!hit) break;
      ASSERT_EQ(counted.count(hit->triangle), 1u);
      past += hit->distance + 1e-4f;
    }
  }
  EXPECT_GT(stops, 50u);
  EXPECT_GT(blocks, 50u);
}

INSTANTIATE_TEST_SUITE_P(Sizes, RandomTrees, ::testing::Values(1, 2, 3, 10, 11, 12, 40, 41, 42));

// Below some depth the triangles count and clusters no longer do.
TEST(MultiresTree, HoldsEveryTriangleOfAChainOfClusters) {
  ShapeScene shapes = clutter(5, 1000);
  ClusteredWorld c(shapes.scene);
  const std::size_t surfaces = c.surfaces.surfaces.size();
  ASSERT_GT(surfaces, 1000u);
  c.clusters = {};
  c.clusters.clusters.resize(surfaces);
  for (std::size_t i = 0; i < surfaces; ++i) {
    c.clusters.clusters[i].surfaces = {SurfaceId(i)};
    if (i > 0) c.clusters.clusters[i - 1].clusters = {static_cast<std::uint32_t>(i)};
  }
  const MultiresTree tree = make_tree(c);
  expect_every_triangle_once(tree, c.world.geometry);
}

TEST(MultiresTree, OfNothingLetsEverythingThrough) {
  const ClusteredWorld empty{Scene{}};
  const MultiresTree tree = make_tree(empty);
  EXPECT_EQ(tree.multires({}, StopRule::widening(1.f, 0.f)), 1.f);
  EXPECT_FALSE(tree.closest_hit({}, StopRule::widening(1.f, 0.f), 1).has_value());
}

TEST(MultiresTree, IsExactWhereNothingStops) {
  ShapeScene shapes = clutter(8, 600);
  const ClusteredWorld c(shapes.scene);
  for (const auto rule : {StopRule::between(1e-7f, 0.f), StopRule::never()}) {
    const MultiresTree tree = make_tree(c);
    int open = 0, veiled = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      Dice dice(hash(i, 5));
      const Vec3 from = dice.point(), to = from + 0.3f * (dice.point() - from);
      const float exact = c.world.rays.transmittance(from, to);
      ASSERT_NEAR(tree.multires({from, to - from, 1.f}, rule), exact, 1e-5f) << i;
      open += exact == 1.f;
      veiled += exact > 0.f && exact < 1.f;
      const Vec3 d = dice.direction();
      ASSERT_NEAR(tree.multires({from, d, kInfinity}, rule),
                  c.world.rays.transmittance_to_sky(from, d), 1e-5f);
      const auto mine = tree.closest_hit({from, d, kInfinity}, rule, i);
      const auto other = c.world.rays.closest_hit(from, d, kInfinity, i);
      ASSERT_EQ(mine.has_value(), other.has_value()) << i;
      if (!mine) continue;
      ASSERT_EQ(mine->surface.triangle, other->triangle) << i;
      ASSERT_EQ(mine->surface.front, other->front);
      ASSERT_NEAR(mine->distance, other->distance, 1e-4f);
      ASSERT_NEAR(mine->surface.barycentric.x, other->barycentric.x, 1e-2f);
    }
    EXPECT_GT(open, 2000);
    EXPECT_GT(veiled, 200);
  }
}

TEST(Visibility, FeatureSizeZeroIsExactBitForBit) {
  const ClusteredWorld c(loose_triangles_scene({4096, 0.1f, 3}));
  for (const auto mode :
       {VisibilityMode::exact, VisibilityMode::average, VisibilityMode::multires}) {
    const Visibility visibility(c.world, c.surfaces, c.clusters, mode);
    for (std::uint64_t i = 0; i < 2000; ++i) {
      Dice dice(i);
      const Vec3 from = dice.point_in(c.world.geometry.bounds);
      const Vec3 to = dice.point_in(c.world.geometry.bounds), d = dice.direction();
      ASSERT_EQ(visibility.transmittance({from, to, 0.f, 0.5f}),
                c.world.rays.transmittance(from, to));
      ASSERT_EQ(visibility.transmittance_to_sky(from, d, 0.f, 0.1f),
                c.world.rays.transmittance_to_sky(from, d));
      const auto mine = visibility.closest_hit(from, d, 10.f, 0.f, 0.1f, i);
      const auto other = c.world.rays.closest_hit(from, d, 10.f, i);
      ASSERT_EQ(mine.has_value(), other.has_value());
      if (!mine) continue;
      ASSERT_EQ(mine->distance, other->distance);
    }
  }
}

// A square blocker between a square light and a wall: the umbra seen by exact rays is as wide as
// the formula says, and the tree resolves it exactly for feature sizes up to that width.
TEST(Criterion, UmbraOfASquareBlockerIsAsWideAsTheFormulaSays) {
  constexpr float kPixel = 0.004f;
  int with_umbra = 0;
  for (std::uint64_t setting = 0; setting < 50; ++setting) {
    Dice dice(setting);
    const float d1 = dice.between(0.5f, 2.f), d2 = dice.between(0.3f, 2.f);
    const float b = dice.between(0.1f, 0.4f), light = dice.between(0.02f, 0.4f);
    ShapeScene shapes;
    shapes.quad(Vec3(0, 0, d2), Vec3(0.5f * b, 0, 0), Vec3(0, 0.5f * b, 0));
    const ClusteredWorld c = testing::cluster(shapes);
    int dark = 0;
    for (int i = -400; i <= 400; ++i) {
      const Vec3 at(kPixel * (static_cast<float>(i) + 0.25f), 0.001f, 0.f);
      bool lit = false;  // the hidden part of the light is convex: its corners tell
      for (const float x : {-0.5f, 0.5f})
        for (const float y : {-0.5f, 0.5f})
          lit |= c.world.rays.transmittance(at, Vec3(light * x, light * y, d1 + d2)) > 0.f;
      dark += !lit;
    }
    const float u = umbra_width(b, light, d1, d2);
    EXPECT_NEAR(kPixel * static_cast<float>(dark), std::max(u, 0.f), kPixel) << setting;
    if (u < 0.02f) continue;
    ++with_umbra;

    MultiresOptions options;
    options.receiver_clearance = 0.f;
    options.extinction = ExtinctionRule::area;  // lets light through a square: stops can be seen
    const MultiresTree tree = make_tree(c, options);
    const Vec3 receiver(0.001f, 0.002f, 0.f), emitter(0.f, 0.f, d1 + d2);
    const auto light_through = [&](float s) {
      return tree.multires({receiver, emitter - receiver, 1.f}, StopRule::between(s, light));
    };
    // The stored box is a little larger than the blocker.
    const float slack = 0.01f * b * (d1 + d2) / d1;
    EXPECT_EQ(light_through(u - slack), 0.f) << setting;
    EXPECT_GT(light_through(u + slack), 0.3f) << setting;
  }
  EXPECT_GT(with_umbra, 20);
}

TEST(Criterion, SunShadowsFadeWithDistance) {
  ShapeScene shapes;
  shapes.quad(Vec3(0, 0, 5.f), Vec3(0.1f, 0, 0), Vec3(0, 0.1f, 0));
  const ClusteredWorld c = testing::cluster(shapes);
  MultiresOptions options;
  options.extinction = ExtinctionRule::area;
  const MultiresTree tree = make_tree(c, options);
  // Five metres below a blocker of 0.2 m its umbra is 0.2 - 5 theta wide.
  const auto light = [&](float s, float theta) {
    return tree.multires({Vec3(0.01f, 0.02f, 0.f), Vec3(0, 0, 1)}, StopRule::widening(s, theta));
  };
  EXPECT_EQ(light(0.145f, 0.01f), 0.f);
  EXPECT_GT(light(0.155f, 0.01f), 0.3f);
  EXPECT_GT(light(0.001f, 0.041f), 0.3f);
}

TEST(MultiresTree, DoesNotStopAtClustersNearOrAroundTheEndsOfARay) {
  ShapeScene shapes = clutter(9, 2000);
  const ClusteredWorld c(shapes.scene);
  const MultiresTree tree = make_tree(c);
  Dice dice(4);
  int stops = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 from = dice.point(), to = 3.f * dice.direction();
    for (const bool average : {false, true})
      for (const auto& part : tree.cut({from, to - from, 1.f}, StopRule::between(9, 9), average)) {
        if (!part.stopped) continue;
        ++stops;
        EXPECT_FALSE(part.box.contains(from));
        EXPECT_FALSE(part.box.contains(to));
        // Of the points of the ray inside the box, the nearest is half a side away or more.
        if (average) continue;
        const Vec3 d = to - from;
        float nearest = 0.f;
        for (int axis = 0; axis < 3; ++axis)
          nearest = std::max(nearest, std::min((part.box.lower[axis] - from[axis]) / d[axis],
                                               (part.box.upper[axis] - from[axis]) / d[axis]));
        EXPECT_GE(nearest * glm::length(d), 0.499f * part.box.longest_side());
      }
  }
  EXPECT_GT(stops, 1000);
}

// Light that a path loses to surfaces and clusters is what the transmittance says.
TEST(MultiresTree, PathsEndAsOftenAsLightIsStopped) {
  ShapeScene shapes = clutter(10, 800);
  const ClusteredWorld c(shapes.scene);
  const MultiresTree tree = make_tree(c);
  const StopRule rule = StopRule::widening(0.3f, 0.1f);
  int absorbed = 0, compared = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    Dice dice(hash(i, 3));
    const VisibilityRay ray{1.6f * dice.point() - 0.3f, dice.direction(), dice.between(0.2f, 1.f)};
    const float light = tree.multires(ray, rule);
    if (light == 0.f || light == 1.f) continue;
    constexpr int kPaths = 4000;
    int through = 0;
    for (std::uint64_t seed = 0; seed < kPaths; ++seed) {
      const auto hit = tree.closest_hit(ray, rule, hash(seed, i));
      through += !hit;
      if (!hit || !hit->in_cluster()) continue;
      ++absorbed;
      ASSERT_LT(hit->distance, ray.reach);
      ASSERT_LT(hit->cluster, c.clusters.clusters.size());
    }
    ++compared;
    EXPECT_NEAR(static_cast<float>(through) / kPaths, light, 0.035f) << i;
  }
  EXPECT_GT(compared, 10);
  EXPECT_GT(absorbed, 1000);
}

TEST(MultiresTree, IsTheSameForAnyNumberOfThreads) {
  ShapeScene shapes = clutter(11, 400);
  const ClusteredWorld c(shapes.scene);
  MultiresOptions options;
  options.blocker_size = BlockerSizeRule::directional;
  options.extinction = ExtinctionRule::directional_coverage;
  const MultiresTree one = make_tree(c, options), other = make_tree(c, options);
  ASSERT_EQ(one.arrays().nodes.size(), other.arrays().nodes.size());
  EXPECT_EQ(std::memcmp(one.arrays().nodes.data(), other.arrays().nodes.data(),
                        one.arrays().nodes.size() * sizeof(MultiresNode)),
            0);
  std::vector<float> parallel(5000);
  const auto light = [&](const MultiresTree& tree, std::size_t i) {
    Dice dice(i);
    const Vec3 from = dice.point(), to = dice.point();
    return tree.multires({from, to - from, 1.f}, StopRule::between(0.1f, 0.1f));
  };
  parallel_for(parallel.size(), 16, [&](std::size_t i) { parallel[i] = light(one, i); });
  for (std::size_t i = 0; i < parallel.size(); ++i) ASSERT_EQ(parallel[i], light(other, i));
}

// All rules for the blocker's size stay close to the exact mean where their shadows are small.
TEST(MultiresTree, KeepsTheMeanLightUnderAnyRuleForBlockerSizes) {
  ShapeScene shapes;
  Dice dice(12);
  for (int i = 0; i < 6000; ++i) {
    const Vec3 at = dice.point();
    shapes.disc(at, dice.frame(), 0.015f, 6);
  }
  const ClusteredWorld c = testing::cluster(shapes);
  for (const auto extinction :
       {ExtinctionRule::area, ExtinctionRule::coverage, ExtinctionRule::directional_coverage})
    for (const auto rule : {BlockerSizeRule::longest_side, BlockerSizeRule::isotropic,
                            BlockerSizeRule::directional}) {
      MultiresOptions options;
      options.blocker_size = rule;
      options.extinction = extinction;
      options.smallest_picture = 0.05f;
      options.smallest_picture = 0.05f;
      const MultiresTree tree = make_tree(c, options);
      double exact = 0.0, mean = 0.0;
      TraversalCount count;
      constexpr int kRays = 8000;
      for (std::uint64_t i = 0; i < kRays; ++i) {
        Dice at(hash(i, 21));
        const Vec3 from(at.number(), at.number(), -1.f), to(at.number(), at.number(), 3.f);
        exact += c.world.rays.transmittance(from, to) / kRays;
        mean +=
            tree.multires({from, to - from, 1.f}, StopRule::between(0.15f, 0.15f), &count) / kRays;
      }
      EXPECT_NEAR(mean, exact, 0.04) << static_cast<int>(rule) << static_cast<int>(extinction);
      EXPECT_GT(count.stops, 8000u);
    }
}

// Extinction of a cluster of clusters knows the gaps between them, that of a sheet that it has
// none.
TEST(MultiresTree, CoverageExtinctionKnowsGapsAndSheets) {
  ShapeScene sheet, clumps;
  sheet.quad(Vec3(0.f), Vec3(1, 0, 0), Vec3(0, 1, 0));
  Dice dice(30);
  for (int clump = 0; clump < 27; ++clump) {
    const Vec3 corner = Vec3(clump % 3, clump / 3 % 3, clump / 9) / 3.f;
    for (int i = 0; i < 200; ++i) {
      const Vec3 at = corner + 0.12f * dice.point();
      clumps.disc(at, dice.frame(), 0.02f, 6);
    }
  }
  const ClusteredWorld c = testing::cluster(clumps);
  double exact = 0.0;
  const auto mean_light = [&](ExtinctionRule rule) {
    MultiresOptions options;
    options.extinction = rule;
    const MultiresTree tree(c.world.scene, c.world.geometry, c.surfaces, one_cluster(c.surfaces),
                            options);
    constexpr int kRays = 20000;
    double mean = exact = 0.0;
    for (std::uint64_t i = 0; i < kRays; ++i) {
      Dice at(hash(i, 22));
      const Vec3 middle = 0.2f + 0.5f * at.point(), way = 4.f * at.direction();
      const Vec3 from = middle - way, to = middle + way;
      exact += c.world.rays.transmittance(from, to) / kRays;
      mean += tree.multires({from, to - from, 1.f}, StopRule::between(9.f, 9.f)) / kRays;
    }
    return mean;
  };
  const double by_area = mean_light(ExtinctionRule::area);
  const double by_coverage = mean_light(ExtinctionRule::coverage);
  EXPECT_NEAR(by_coverage, exact, 0.05);
  EXPECT_LT(by_area, exact - 0.08);
  const ClusteredWorld flat = testing::cluster(sheet);
  EXPECT_LT(make_tree(flat).multires({Vec3(0.1f, 0.2f, -3.f), Vec3(0, 0, 1)},
                                     StopRule::widening(9.f, 0.f)),
            0.01f);
}

}  // namespace
}  // namespace halflight
