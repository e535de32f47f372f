// Punctual lights against the formulas of KHR_lights_punctual.
#include "halflight/scene/punctual_light.h"

#include <gtest/gtest.h>

namespace halflight {
namespace {

PunctualLight lamp_at(const Vec3& position, Light::Kind kind) {
  PunctualLight lamp;
  lamp.kind = kind;
  lamp.position = position;
  lamp.direction = Vec3(0.f, -1.f, 0.f);
  lamp.intensity = Rgb(12.f);
  lamp.range = kInfinity;
  return lamp;
}

TEST(PunctualLight, OfAPointFallsWithTheSquareOfTheDistance) {
  const PunctualLight lamp = lamp_at({0, 3, 0}, Light::Kind::point);
  EXPECT_FLOAT_EQ(facing_irradiance(lamp, {0, 0, 4}).g, 12.f / 25.f);
  EXPECT_EQ(facing_irradiance(lamp, lamp.position).g, 0.f);
  const Vec3 towards = direction_to(lamp, {0, 0, 4});
  EXPECT_FLOAT_EQ(towards.y, 0.6f);
  EXPECT_FLOAT_EQ(towards.z, -0.8f);
}

TEST(PunctualLight, OfADirectionIsTheSameEverywhere) {
  const PunctualLight sun = lamp_at({0, 0, 0}, Light::Kind::directional);
  EXPECT_EQ(facing_irradiance(sun, {5, 6, 7}).g, 12.f);
  EXPECT_EQ(direction_to(sun, {5, 6, 7}), Vec3(0.f, 1.f, 0.f));
}

// max(0, min(1, 1 - (d / range)^4))
TEST(PunctualLight, OfALimitedRangeFadesByTheFourthPower) {
  EXPECT_FLOAT_EQ(range_window(1.f, 2.f), 15.f / 16.f);
  EXPECT_EQ(range_window(3.f, 2.f), 0.f);
  EXPECT_EQ(range_window(3.f, kInfinity), 1.f);
}

// The square of (cos - cos_outer) / (cos_inner - cos_outer).
TEST(PunctualLight, OfASpotFadesByTheSquareBetweenItsCones) {
  PunctualLight spot = lamp_at({0, 4, 0}, Light::Kind::spot);
  spot.cos_inner = 0.9f;
  spot.cos_outer = 0.5f;
  EXPECT_FLOAT_EQ(spot_falloff(spot, 0.95f), 1.f);
  EXPECT_NEAR(spot_falloff(spot, 0.6f), 1.f / 16.f, 1e-6f);
  EXPECT_EQ(spot_falloff(spot, 0.4f), 0.f);
  EXPECT_NEAR(facing_irradiance(spot, {3, 0, 0}).g, 12.f / 25.f * 0.75f * 0.75f, 1e-5f);
}

}  // namespace
}  // namespace halflight
