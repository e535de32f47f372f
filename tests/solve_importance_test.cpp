// Feature sizes of parts of the scene and of views, and importance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "halflight/rays/path_tracer.h"
#include "halflight/scene/procedural/doorway.h"
#include "halflight/solve/importance.h"
#include "quad_scene.h"
#include "sanitized.h"
#include "solved_scene.h"

namespace halflight {
namespace {

// The room with the light lies at x < 0, the dim one beyond the doorway.
ViewOfInterest view_of(const World& world, bool bright_room) {
  const Vec3 centre = world.geometry.bounds.center();
  ViewOfInterest view{PlacedCamera(), 320, 180};
  const float side = bright_room ? -1.f : 1.f;
  view.camera.position = centre + Vec3(side * 0.2f * world.geometry.bounds.diagonal(), 0.f, 0.f);
  view.camera.forward = Vec3(side, 0.f, 0.f);
  return view;
}

TEST(FeatureSizes, LastRuleThatMatchesHolds) {
  const auto world = make_world(doorway_scene());
  const Surfaces surfaces = build_surfaces(world->geometry);
  const std::string name = world->scene.materials[world->geometry.materials[TriangleId(0)]].name;
  const std::vector<FeatureSizeRule> rules{{"*", "", 0.3f}, {name, "", 0.02f}};
  const FeatureSizes sizes(*world, surfaces, 0.1f, rules, std::nullopt);
  std::size_t own = 0;
  for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
    const TriangleId t = surfaces.triangles[surfaces[SurfaceId(i)].first_triangle];
    const bool same = world->scene.materials[world->geometry.materials[t]].name == name;
    Element cell;
    cell.side = side_of(SurfaceId(i), false);
    EXPECT_FLOAT_EQ(sizes.of_cell(cell), same ? 0.02f : 0.3f);
    own += same;
  }
  EXPECT_GT(own, 0u);
  EXPECT_LT(own, surfaces.surfaces.size());
}

TEST(FeatureSizes, RuleThatMatchesNothingIsAnError) {
  const auto world = make_world(doorway_scene());
  EXPECT_TRUE(check_rules({{"*", "", 0.1f}}, *world, "rules.toml"));
  const auto missing = check_rules({{"Unobtainium", "", 0.1f}}, *world, "rules.toml");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().line().find("Unobtainium"), std::string::npos);
}

// A node's rule is about all below it; with a material, about what has both.
TEST(FeatureSizes, NodesAreMatchedWithAllBelowThem) {
  testing::QuadScene quads;
  Node node;
  node.name = "furniture";
  const NodeId furniture = quads.scene.nodes.push_back(node);
  const MaterialId wood = quads.material(0.5f), steel = quads.material(0.4f);
  quads.scene.materials[wood].name = "wood";
  quads.scene.materials[steel].name = "steel";
  const auto quad = [&](float height, MaterialId material, const std::string& name, NodeId parent) {
    quads.quad(Vec3(0.f, height, 0.f), Vec3(0.f, 0.f, 1.f), Vec3(1.f, 0.f, 0.f), material);
    quads.scene.nodes.back().name = name;
    quads.scene.nodes.back().parent = parent;
  };
  quad(0.f, wood, "floor", NodeId());
  quad(1.f, wood, "table top", furniture);
  quad(2.f, steel, "table leg", furniture);
  const auto world = make_world(quads.scene);
  const Surfaces surfaces = build_surfaces(world->geometry);
  // Sizes of the floor, the top and the leg.
  const auto sizes = [&](const std::vector<FeatureSizeRule>& rules) {
    const FeatureSizes all(*world, surfaces, 0.1f, rules, std::nullopt);
    std::array<float, 3> of{};
    for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
      const TriangleId t = surfaces.triangles[surfaces[SurfaceId(i)].first_triangle];
      Element cell;
      cell.side = side_of(SurfaceId(i), false);
      of.at(world->geometry.instances[t].value) = all.of_cell(cell);
    }
    return of;
  };
  using Sizes = std::array<float, 3>;
  EXPECT_EQ(sizes({{"", "table top", 0.02f}}), (Sizes{0.1f, 0.02f, 0.1f}));
  EXPECT_EQ(sizes({{"", "table*", 0.02f}}), (Sizes{0.1f, 0.02f, 0.02f}));
  EXPECT_EQ(sizes({{"", "furniture", 0.02f}}), (Sizes{0.1f, 0.02f, 0.02f}));
  EXPECT_EQ(sizes({{"wood", "furniture", 0.02f}}), (Sizes{0.1f, 0.02f, 0.1f}));
  const auto nowhere = check_rules({{"steel", "floor", 0.02f}}, *world, "rules.toml");
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().line().find("material 'steel' and node 'floor'"), std::string::npos);
}

// Trying what each star covers would take longer than the universe has been there.
TEST(FeatureSizes, RulesOfManyStarsAreAnsweredAtOnce) {
  Scene scene = doorway_scene();
  for (Material& m : scene.materials) m.name = std::string(200, 'a');
  const auto world = make_world(std::move(scene));
  std::string stars;
  for (int i = 0; i < 60; ++i) stars += "*a";
  EXPECT_TRUE(check_rules({{stars, "", 0.1f}}, *world, "rules.toml"));
  EXPECT_TRUE(check_rules({{stars + "***", "", 0.1f}}, *world, "rules.toml"));
  EXPECT_FALSE(check_rules({{stars + "*b", "", 0.1f}}, *world, "rules.toml"));
}

// Once per material and node; not per triangle, nor anew for each node above it.
TEST(FeatureSizes, RulesForLongNamesAndDeepNodesAreAnsweredSoon) {
  Scene scene = doorway_scene();
  for (Material& m : scene.materials) m.name = std::string(100'000, 'a');
  Node node;
  node.name = "chain";
  for (int i = 0; i < 20'000; ++i) node.parent = scene.nodes.push_back(node);
  node.mesh = scene.nodes[NodeId(0)].mesh;
  for (int i = 0; i < 20; ++i) scene.nodes.push_back(node);
  node.name = "last";
  scene.nodes.push_back(node);
  const auto world = make_world(std::move(scene));
  const std::string letters(250, 'a');
  std::vector<FeatureSizeRule> rules(500, {"", "last", 0.1f});
  rules.push_back({"*" + letters + "*", "", 0.1f});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(check_rules(rules, *world, "rules.toml"));
  rules.push_back({"*" + letters + "b*", "", 0.1f});
  EXPECT_FALSE(check_rules(rules, *world, "rules.toml"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin,
            std::chrono::seconds(test::kThreadSanitized ? 30 : 3));
}

TEST(FeatureSizes, StarsStandForAnyLetters) {
  Scene scene = doorway_scene();
  for (Material& m : scene.materials) m.name = "Floor.tiles\xc3\xa9";
  const auto world = make_world(std::move(scene));
  for (const char* pattern :
       {"*", "**", "Floor*", "*tiles\xc3\xa9", "F*.*\xa9", "Floor.tiles\xc3\xa9",
        "*Floor.tiles\xc3\xa9*", "*o*o*", "F*l*o*o*r*", "*s\xc3*"})
    EXPECT_TRUE(check_rules({{pattern, "", 0.1f}}, *world, "")) << pattern;
  for (const char* pattern :
       {"Floor", "loor*", "floor*", "*tile", "*oo*oo*", "*x*", "Floor.tiles\xc3\xa9?*a"})
    EXPECT_FALSE(check_rules({{pattern, "", 0.1f}}, *world, "")) << pattern;
}

TEST(FeatureSizes, PixelsGrowWithDistance) {
  const auto world = make_world(doorway_scene());
  const Surfaces surfaces = build_surfaces(world->geometry);
  PixelFeatureSize pixels{view_of(*world, true), 4.f};
  const FeatureSizes sizes(*world, surfaces, 0.1f, {}, pixels);
  Element cell;
  cell.side = side_of(SurfaceId(0), false);
  const auto at = [&](float distance) {
    cell.box = {};
    cell.box.extend(pixels.view.camera.position + distance * pixels.view.camera.forward);
    return sizes.of_cell(cell);
  };
  // A pixel of 180 in a field of view of 0.8 radians.
  const float pixel = 2.f * std::tan(0.4f) / 180.f;
  EXPECT_NEAR(at(1.f), 4.f * pixel, 1e-5f);
  EXPECT_NEAR(at(5.f), 20.f * pixel, 1e-5f);
}

TEST(FeatureSizes, RefineWhereTheyAreSmall) {
  SolveOptions options = testing::options_of(LinkMaker::sampled, 0.4f);
  const SolverState plain = testing::solve(doorway_scene(), options);
  const auto world = make_world(doorway_scene());
  const MaterialId floor = world->geometry.materials[TriangleId(0)];
  options.feature_size_rules = {{world->scene.materials[floor].name, "", 0.05f}};
  const SolverState ruled = testing::solve(doorway_scene(), options);
  const auto smallest = [&](const SolverState& state, bool on_it) {
    float size = kInfinity;
    for (std::size_t i = 0; i < state.tree.size(); ++i) {
      const ElementId e(i);
      if (state.tree[e].is_cluster()) continue;
      if ((state.tree.surfaces()[state.tree[e].side].material == floor) == on_it)
        size = std::min(size, state.tree.cell_size(e));
    }
    return size;
  };
  EXPECT_LT(smallest(ruled, true), 0.6f * smallest(plain, true));
  EXPECT_GT(ruled.tree.size(), plain.tree.size());
}

TEST(Importance, SeesThroughReflections) {
  SolverState state =
      make_state(make_world(doorway_scene()), testing::options_of(LinkMaker::sampled, 0.2f));
  advance(state, Progress());
  advance(state, Progress());
  const auto seen = seen_surfaces(*state.world, view_of(*state.world, false));
  ASSERT_GT(seen.size(), 10'000u);
  const auto importance = solve_importance(state, seen);
  float least = 1.f, most = 0.f;
  for (const float i : importance) {
    least = std::min(least, i);
    most = std::max(most, i);
  }
  EXPECT_GE(least, kLeastImportance);
  EXPECT_FLOAT_EQ(most, 1.f);
  for (const RayHit& hit : seen) EXPECT_FLOAT_EQ(importance[state.tree.leaf_hit(hit)], 1.f);
  // The bright room is out of sight, yet its light comes through the doorway.
  std::size_t between = 0;
  for (const float i : importance) between += i > 2.f * kLeastImportance && i < 0.9f;
  EXPECT_GT(between, 100u);
}

TEST(Importance, KeepsTheViewForLess) {
  SolveOptions options = testing::options_of(LinkMaker::sampled, 0.1f);
  const auto world = make_world(doorway_scene());
  const SolverState whole = testing::solve(world, options);
  options.importance = view_of(*world, true);
  const SolverState seen = testing::solve(world, options);
  EXPECT_LT(seen.sampled_links.size(), 0.8f * whole.sampled_links.size());
  // Points of the view, read in both.
  std::vector<ReadingPoint> points;
  const Geometry& g = world->geometry;
  for (std::size_t i = 0; i < seen.seen.size(); i += seen.seen.size() / 200) {
    const RayHit& hit = seen.seen[i];
    points.push_back({hit_position(g, hit), hit_normal(g, hit), hit.triangle});
  }
  const auto a = testing::read_irradiance(whole, points),
             b = testing::read_irradiance(seen, points);
  EXPECT_NEAR(testing::mean(b) / testing::mean(a), 1.f, 0.02f);
  float worst = 0.f;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]) / std::max(a[i], testing::mean(a)));
  EXPECT_LT(worst, 0.1f);
}

}  // namespace
}  // namespace halflight
