// Sampled transfers: reciprocity (A_r F_rs = A_s F_sr) with and without something in between,
// closed forms where elements touch, and what turns its back.
#include "halflight/transport/transfer.h"

#include <gtest/gtest.h>

#include "closed_forms.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

constexpr int kSamples = 4096;

SolverState state_of(const QuadScene& scene) {
  return make_state(make_world(scene.scene), testing::options_of(LinkMaker::refined, 0.1f));
}

// A floor of 2 x 1 m and above it a panel of 1 x 0.5 m; an opaque or clear pane half across.
SolverState panel_over_floor(float height, float pane_opacity) {
  QuadScene scene;
  const MaterialId glowing = scene.material(0.f, 1.f);
  scene.quad({0, 0, 0}, {0, 0, 1}, {2, 0, 0}, glowing);
  scene.quad({0.3f, height, 0.2f}, {1, 0, 0}, {0, 0, 0.5f}, glowing);
  if (pane_opacity > 0.f)
    scene.quad({0, 0.5f * height, -1}, {0.8f, 0, 0}, {0, 0, 3}, scene.pane(pane_opacity));
  return state_of(scene);
}

ElementId front_of_triangle(const SolverState& state, std::size_t triangle) {
  return state.tree.side_root(side_of(state.surfaces->of_triangle[TriangleId(triangle)], false));
}

TransferScene transfer_scene(const SolverState& state) {
  return {state.tree, *state.visibility, 0.f, state.radiosity, state.opacity};
}

float weight(const SolverState& state, ElementId receiver, ElementId source) {
  return estimate_transfer(transfer_scene(state), receiver, source, kSamples, 1).weight;
}

float touching_weight(const SolverState& state, ElementId receiver, ElementId source) {
  return estimate_touching_transfer(transfer_scene(state), receiver, source, kSamples, 1).weight;
}

// Near cells, for which a closed form is multiplied by mean visibility, exchange as much only where
// nothing is in between.
struct Exchange {
  float height, pane_opacity;
};
class Reciprocity : public ::testing::TestWithParam<Exchange> {};

TEST_P(Reciprocity, BothEndsExchangeTheSamePower) {
  const SolverState state = panel_over_floor(GetParam().height, GetParam().pane_opacity);
  const ElementId floor = front_of_triangle(state, 0), panel = front_of_triangle(state, 2);
  const float to_floor = state.tree[floor].area * weight(state, floor, panel);
  const float to_panel = state.tree[panel].area * weight(state, panel, floor);
  EXPECT_GT(to_floor, 0.002f);
  EXPECT_NEAR(to_floor, to_panel, 0.015f * to_floor);
}

INSTANTIATE_TEST_SUITE_P(HeightsAndPanes, Reciprocity,
                         ::testing::Values(Exchange{1.f, 0.f}, Exchange{7.f, 0.f},
                                           Exchange{7.f, 0.4f}, Exchange{7.f, 1.f}));

TEST(Transfer, ATranslucentPaneInFrontOfEverythingScalesTheWeight) {
  QuadScene scene;
  const MaterialId glowing = scene.material(0.f, 1.f);
  scene.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, glowing);
  scene.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, glowing);
  scene.quad({-1, 0.5f, -1}, {3, 0, 0}, {0, 0, 3}, scene.pane(0.25f));
  const SolverState state = state_of(scene);
  EXPECT_NEAR(weight(state, front_of_triangle(state, 0), front_of_triangle(state, 2)),
              0.75f * 0.199825f, 0.01f * 0.199825f);
}

TEST(Transfer, ElementsThatTurnTheirBacksExchangeNothing) {
  const SolverState state = panel_over_floor(1.f, 0.f);
  const SurfaceId floor = state.surfaces->of_triangle[TriangleId(0)];
  const ElementId under_floor = state.tree.side_root(side_of(floor, true));
  const ElementId panel = front_of_triangle(state, 2);
  if (under_floor.valid()) {
    EXPECT_TRUE(back_facing(state.tree, under_floor, panel));
  }
  EXPECT_FALSE(back_facing(state.tree, front_of_triangle(state, 0), panel));
}

// What lets light through would not hide its own front from behind.
TEST(Transfer, ATranslucentPanelThatShinesUpwardsLeavesTheFloorBelowDark) {
  QuadScene scene;
  const MaterialId grey = scene.material(0.5f);
  scene.scene.materials[grey].alpha_mode = AlphaMode::blend;
  const MaterialId glowing = scene.pane(0.5f);
  scene.scene.materials[glowing].emission = Rgb(1.f);
  scene.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, grey);
  scene.quad({0, 0.5f, 0}, {0, 0, 1}, {1, 0, 0}, glowing);
  const SolverState state = state_of(scene);
  const ElementId floor = front_of_triangle(state, 0), panel = front_of_triangle(state, 2);
  EXPECT_TRUE(back_facing(state.tree, floor, panel));
  EXPECT_EQ(weight(state, floor, panel), 0.f);
}

TEST(TouchingTransfer, IsTheFormFactorOfPlatesThatShareAnEdge) {
  QuadScene scene;
  const MaterialId glowing = scene.material(0.f, 1.f);
  scene.quad({0, 0, 0}, {0, 0, 1}, {2, 0, 0}, glowing);
  scene.quad({0, 0, 0}, {0, 1.5f, 0}, {0, 0, 1}, glowing);
  const SolverState state = state_of(scene);
  const ElementId floor = front_of_triangle(state, 0), wall = front_of_triangle(state, 2);
  EXPECT_TRUE(bound_transfer(state.tree, nullptr, floor, wall).touching);
  const auto expected = static_cast<float>(testing::factor_of_perpendicular_rectangles(2, 1.5, 1));
  EXPECT_NEAR(touching_weight(state, floor, wall), expected, 0.02f * expected);
}

// Of a cube whose ceiling glows, all sides as one cluster send a sixth of that light on the mean.
TEST(TouchingTransfer, GivesTheFloorTheLightOfTheRoomAroundIt) {
  QuadScene scene;
  scene.box({0, 0, 0}, {1, 1, 1}, scene.material(0.f), true);
  constexpr std::size_t kFloor = 4, kCeiling = 6;  // first triangles
  scene.scene.meshes[MeshId(kCeiling / 2)].primitives[0].material = scene.material(0.f, 1.f);
  const SolverState state = state_of(scene);
  const ElementId floor = front_of_triangle(state, kFloor);
  const ElementId ceiling = front_of_triangle(state, kCeiling);
  const ElementId room = state.tree.root();
  ASSERT_FLOAT_EQ(state.radiosity[ceiling].g, 6.f * state.radiosity[room].g);
  const auto expected = static_cast<float>(testing::factor_of_parallel_rectangles(1, 1, 1));
  EXPECT_NEAR(touching_weight(state, floor, room), 6.f * expected, 0.06f * expected);
}

}  // namespace
}  // namespace halflight
