// Light from punctual lamps and the sky on single points.
#include "halflight/transport/outer_light.h"

#include <gtest/gtest.h>

#include "halflight/rays/sampling.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::kDown;
using testing::kUp;
using testing::QuadScene;

QuadScene floor_with_a_pane(float pane_opacity) {
  QuadScene scene;
  scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, scene.material(0.5f));
  scene.quad({-9, 1, -9}, {18, 0, 0}, {0, 0, 9}, scene.pane(pane_opacity));  // over z < 0
  return scene;
}

// Intensity times cosine over squared distance, and the share that a pane lets through.
TEST(PunctualIrradiance, FallsOnWhatFacesItThroughWhatStandsBetween) {
  QuadScene scene = floor_with_a_pane(0.25f);
  Light lamp;
  lamp.intensity = Rgb(50.f);
  scene.light_shining_down(lamp, {0.f, 4.f, 0.f});
  const World world(scene.scene);
  const Visibility visibility(world);
  const Vec3 x(0.6f, 0.f, 0.8f), behind_pane(0.6f, 0.f, -0.8f);
  const float squared = 17.f, expected = 50.f * 4.f / (squared * std::sqrt(squared));
  EXPECT_NEAR(punctual_irradiance(visibility, x, kUp, 0.f).g, expected, 1e-4f * expected);
  EXPECT_NEAR(punctual_irradiance(visibility, behind_pane, kUp, 0.f).g, 0.75f * expected,
              1e-4f * expected);
  EXPECT_EQ(punctual_irradiance(visibility, {5.f, 0.f, 5.f}, kDown, 0.f).g, 0.f);
}

TEST(SkyLight, OfAnOpenPointIsPiTimesItsRadiance) {
  QuadScene scene = floor_with_a_pane(1.f);
  scene.scene.sky = Rgb(1.f, 2.f, 3.f);
  const World world(scene.scene);
  const Visibility visibility(world);
  const auto sky = [&](const Vec3& x, const Vec3& n) {
    return sky_irradiance(visibility, x, n, 1024, Vec2(0.5f), 0.f);
  };
  EXPECT_NEAR(sky({0, 2, 0}, kUp).r, kPi, 1e-3f);
  EXPECT_NEAR(sky({0, 2, 0}, kUp).b, 3.f * kPi, 3e-3f);
  // The cover reaches from overhead to where the sky gives nothing any more: about half is left.
  const float covered = testing::corner_form_factor(9.f, 9.f, 1.f);
  EXPECT_NEAR(sky({0, 0, 0}, kUp).g, 2.f * kPi * (1.f - 2.f * covered), 0.02f * kPi);
}

}  // namespace
}  // namespace halflight
