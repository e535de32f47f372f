// Energy: what lamps emit is absorbed, or leaves through openings, and nothing else happens to it.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "halflight/scene/procedural/books.h"
#include "halflight/scene/procedural/cornell_box.h"
#include "halflight/scene/procedural/doorway.h"
#include "halflight/scene/procedural/office.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

TEST(Energy, LampAloneInSpaceLosesEverything) {
  QuadScene scene;
  scene.quad({0, 0, 0}, {1, 0, 0}, {0, 0, 2}, scene.material(0.5f, 3.f));
  const EnergyBalance balance =
      energy_balance(testing::solve(scene.scene, testing::options_of(LinkMaker::refined, 0.1f)));
  EXPECT_NEAR(balance.emitted.g, kPi * 3.f * 2.f, 1e-3f);
  EXPECT_EQ(balance.absorbed.g, 0.f);
}

// A glowing pane sends the share of its light that its surface is there: to cells, and to sensors.
TEST(Energy, GlowingPaneSendsWhatItEmits) {
  QuadScene scene;
  scene.box({0, 0, 0}, {4, 3, 4}, scene.material(0.f), true);
  const MaterialId pane = scene.pane(0.3f);
  scene.scene.materials[pane].emission = Rgb(10.f);
  scene.quad({1, 2, 1}, {1, 0, 0}, {0, 0, 1}, pane);
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::sampled, 0.1f));
  const EnergyBalance balance = energy_balance(state);
  EXPECT_NEAR(balance.emitted.g, 0.3f * kPi * 10.f, 1e-3f);
  EXPECT_NEAR(balance.absorbed.g / balance.emitted.g, 1.f, 0.02f);
  const float expected = 0.3f * kPi * 10.f * 4.f * testing::corner_form_factor(0.5f, 0.5f, 2.f);
  const Reading reading =
      SolutionReader(state, {}).read({{1.5f, 0.f, 1.5f}, testing::kUp, {}, false});
  EXPECT_NEAR(reading.irradiance().g / expected, 1.f, 0.01f);
}

// Between unit squares at distance 1, F = 0.199825: the black one absorbs that share.
TEST(Energy, WhatMissesTheOtherSquareEscapes) {
  QuadScene scene;
  scene.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, scene.material(0.f));
  scene.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, scene.material(0.f, 1.f));
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled}) {
    const EnergyBalance balance =
        energy_balance(testing::solve(scene.scene, testing::options_of(links, 0.05f, 0.01f)));
    EXPECT_NEAR(balance.absorbed.g / kPi, 0.199825f, 0.002f);
    EXPECT_NEAR(balance.escaped.g / kPi, 1.f - 0.199825f, 0.008f);
  }
}

Scene room_with_blocks() {
  QuadScene scene;
  const MaterialId white = scene.material(0.7f), grey = scene.material(0.4f);
  scene.box({0, 0, 0}, {3, 2.5f, 4}, white, true);
  scene.box({0.5f, 0.01f, 0.5f}, {1.2f, 1.4f, 1.2f}, grey, false);
  scene.box({1.6f, 0.01f, 2}, {2.5f, 0.7f, 3}, grey, false);
  scene.quad({1, 2.45f, 1.5f}, {1, 0, 0}, {0, 0, 0.6f}, scene.material(0.5f, 10.f));
  return scene.scene;
}

Scene small_office() {
  OfficeParameters p;
  p.count = 60;
  return office_scene(p);
}

// Rays of sampled links keep energy to 1 %. Refined links lose up to 2 % by their own errors, and
// cells of 0.4 m make up to 3 % in the nooks between the small things of the office.
struct ClosedRoom {
  const char* name;
  std::function<Scene()> build;
  float feature_size;
  LinkMaker links;
  float tolerance = 0.01f;
};

class ClosedRooms : public ::testing::TestWithParam<ClosedRoom> {};

TEST_P(ClosedRooms, AbsorbAllThatIsEmitted) {
  const ClosedRoom& room = GetParam();
  const EnergyBalance balance = energy_balance(
      testing::solve(room.build(), testing::options_of(room.links, room.feature_size, 0.02f)));
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_GT(balance.emitted[channel], 0.f);
    EXPECT_NEAR(balance.absorbed[channel] / balance.emitted[channel], 1.f, room.tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rooms, ClosedRooms,
    ::testing::Values(
        ClosedRoom{"BlocksRefined", room_with_blocks, 0.2f, LinkMaker::refined, 0.02f},
        ClosedRoom{"BlocksSampled", room_with_blocks, 0.2f, LinkMaker::sampled},
        ClosedRoom{"DoorwayRefined", [] { return doorway_scene(); }, 0.3f, LinkMaker::refined,
                   0.02f},
        ClosedRoom{"DoorwaySampled", [] { return doorway_scene(); }, 0.3f, LinkMaker::sampled},
        ClosedRoom{"BooksSampled", [] { return books_scene(); }, 0.4f, LinkMaker::sampled},
        ClosedRoom{"OfficeSampled", small_office, 0.4f, LinkMaker::sampled, 0.03f}),
    [](const auto& test) { return std::string(test.param.name); });

// Panes of opacity 0.3 divide the room; what they stop they reflect to 0.8.
Scene room_with_screens() {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.4f), true);
  scene.quad({1, 2.45f, 0.3f}, {1, 0, 0}, {0, 0, 0.6f}, scene.material(0.5f, 10.f));
  const MaterialId screen = scene.pane(0.3f);
  scene.scene.materials[screen].reflectance = Rgb(0.8f);
  for (const float z : {1.2f, 1.8f, 2.4f, 3.f})
    scene.quad({0.01f, 0.01f, z}, {2.98f, 0, 0}, {0, 2.48f, 0}, screen);
  return scene.scene;
}

class Screens : public ::testing::TestWithParam<LinkMaker> {};

TEST_P(Screens, WhatTheyLetThroughIsNotAbsorbed) {
  const EnergyBalance balance = energy_balance(
      testing::solve(room_with_screens(), testing::options_of(GetParam(), 0.1f, 0.02f)));
  EXPECT_NEAR(balance.absorbed.g / balance.emitted.g, 1.f,
              GetParam() == LinkMaker::refined ? 0.02f : 0.01f);
}

// A cell of a screen reflects opacity x reflectance of what falls on it, once.
TEST_P(Screens, WallBehindThemIsLitAsPathTraced) {
  const SolverState state =
      testing::solve(room_with_screens(), testing::options_of(GetParam(), 0.1f, 0.02f));
  const PathTracer tracer(*state.world);
  const SolutionReader reader(state, {.gather_rays = 4096, .direct = {}});
  for (const Vec3 wall : {Vec3(0.7f, 1.f, 4.f), Vec3(1.5f, 0.5f, 4.f), Vec3(2.2f, 2.f, 4.f)}) {
    const Vec3 n(0, 0, -1);
    const float expected = tracer.estimate_irradiance(wall, n, 1u << 15, 3).mean.g;
    EXPECT_NEAR(reader.read({wall, n, {}}).irradiance().g / expected, 1.f, 0.04f);
  }
}

INSTANTIATE_TEST_SUITE_P(Links, Screens, ::testing::Values(LinkMaker::refined, LinkMaker::sampled),
                         [](const auto& test) {
                           return test.param == LinkMaker::refined ? "Refined" : "Sampled";
                         });

// A black lid absorbs what left the open box: the path tracer says how much falls on it.
TEST(Energy, OpenCornellBoxLosesWhatALidWouldReceive) {
  const auto world = make_world(cornell_box_scene());
  const EnergyBalance balance =
      energy_balance(testing::solve(world, testing::options_of(LinkMaker::sampled, 0.02f)));
  const Bounds3f& box = world->geometry.bounds;
  const PathTracer tracer(*world);
  constexpr int kSide = 16;
  // The box is open where the camera looks in.
  const bool open_at_low_z = world->geometry.cameras.at(0).position.z < box.center().z;
  const float z = open_at_low_z ? box.lower.z : box.upper.z;
  const Vec3 inwards(0, 0, open_at_low_z ? 1 : -1);
  float received = 0.f;
  for (int i = 0; i < kSide; ++i)
    for (int k = 0; k < kSide; ++k) {
      const Vec3 t((static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(k) + 0.5f) / kSide,
                   0.f);
      Vec3 at = box.lower + t * box.extent();
      at.z = z - 1e-4f * inwards.z;
      received += tracer.estimate_irradiance(at, inwards, 256, hash(i, k)).mean.g;
    }
  received *= box.extent().x * box.extent().y / (kSide * kSide);
  EXPECT_NEAR(balance.escaped.g / balance.emitted.g, received / balance.emitted.g, 0.01f);
}

}  // namespace
}  // namespace halflight
