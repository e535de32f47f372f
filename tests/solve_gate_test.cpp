// The feature size gates refinement: what is coarser then must still reflect as much light.
#include <gtest/gtest.h>

#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::kDown;
using testing::QuadScene;
using testing::Traced;

// Irradiance at a place in the air, solved, as a share of the path-traced one.
float share_of_traced(const QuadScene& scene, float feature_size, const Vec3& x, const Vec3& n) {
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::sampled, feature_size));
  const Reading reading = SolutionReader(state, {}).read({x, n, {}, false});
  return reading.irradiance().g / Traced(scene).irradiance(x, n, 1u << 19);
}

// A bulb in a bowl: no cluster of the bowl can be lit as one, not even those without the bulb.
TEST(Gate, LampFarSmallerThanTheFeatureSizeShinesAsFine) {
  QuadScene scene;
  scene.box({0, 0, 0}, {4, 3, 4}, scene.material(0.2f), true);
  scene.ball({2, 1, 2}, 0.15f, scene.material(0.8f), true, 12, 0.05f);
  scene.ball({2, 0.98f, 2}, 0.04f, scene.material(0.f, 500.f), false, 6);
  const float fine = share_of_traced(scene, 0.02f, {2, 1.6f, 2}, kDown);
  const float coarse = share_of_traced(scene, 1.f, {2, 1.6f, 2}, kDown);
  EXPECT_NEAR(fine, 1.f, 0.04f);
  EXPECT_NEAR(coarse, 1.f, 0.04f);
}

// What is seen of a cell is mostly the part that things do not stand over.
TEST(Gate, FloorHalfUnderLowShelvesReflectsMoreLikeItsOpenHalf) {
  QuadScene scene;
  const MaterialId black = scene.material(0.f);
  scene.box({0, 0, 0}, {2, 2, 2}, black, true);
  scene.quad({0, 0.01f, 0}, {0, 0, 2}, {2, 0, 0}, scene.material(0.8f));
  for (const float x : {0.f, 0.5f, 1.f, 1.5f})
    scene.quad({x, 0.06f, 0}, {0, 0, 2}, {0.25f, 0, 0}, black);
  scene.quad({0.7f, 1.99f, 0.7f}, {0.6f, 0, 0}, {0, 0, 0.6f}, scene.material(0.f, 10.f));
  // Half of it if the floor under the shelves counted alike.
  EXPECT_GT(share_of_traced(scene, 1.f, {0.3f, 1.9f, 1.f}, kDown), 0.62f);
}

}  // namespace
}  // namespace halflight
