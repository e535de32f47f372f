#include <gtest/gtest.h>

#include "halflight/rays/sensor_placement.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::kDown;
using testing::kUp;
using testing::QuadScene;
using testing::Traced;

// A 10 m room: the reach of a sensor is 1.7 mm.
QuadScene room() {
  QuadScene quads;
  quads.box(Vec3(0.f), Vec3(10.f), quads.material(0.5f), true);
  return quads;
}

TEST(SensorPlacement, AHairOffOrUnderTheFloorReadsTheFloor) {
  const Traced t(room());
  for (const float height : {-5e-4f, -1e-5f, 0.f, 1e-5f, 5e-4f}) {
    const auto at = place_sensor(t.geometry, t.rays, {3.f, height, 4.f}, kUp);
    ASSERT_TRUE(at.triangle.valid()) << height;
    EXPECT_NEAR(glm::distance(at.position, Vec3(3.f, 0.f, 4.f)), 0.f, 1e-6f);
    EXPECT_EQ(at.normal, kUp);
    EXPECT_TRUE(at.front);
    const auto [a, b, c] = t.geometry.corners(at.triangle);
    EXPECT_NEAR(
        glm::distance(a + at.barycentric.x * (b - a) + at.barycentric.y * (c - a), at.position),
        0.f, 1e-5f);
  }
}

TEST(SensorPlacement, TheNormalChoosesTheSide) {
  const Traced t(room());
  const auto at = place_sensor(t.geometry, t.rays, {3.f, 0.f, 4.f}, kDown);
  ASSERT_TRUE(at.triangle.valid());
  EXPECT_FALSE(at.front);
  EXPECT_EQ(at.normal, kDown);
}

TEST(SensorPlacement, InACornerTheSurfaceThatFacesAlongTheNormalIsTaken) {
  const Traced t(room());
  const auto floor = place_sensor(t.geometry, t.rays, {0.f, 0.f, 4.f}, kUp);
  EXPECT_EQ(floor.normal, kUp);
  const auto wall = place_sensor(t.geometry, t.rays, {0.f, 0.f, 4.f}, {1.f, 0.f, 0.f});
  EXPECT_EQ(wall.normal, Vec3(1.f, 0.f, 0.f));
}

TEST(SensorPlacement, OfAStackThinnerThanRoundingTheOutermostLayerIsRead) {
  QuadScene quads = room();  // rounding: 10 m * 2^-17 = 0.076 mm
  const MaterialId paper = quads.material(0.8f);
  quads.quad({2.f, 2e-4f, 2.f}, {0.f, 0.f, 4.f}, {4.f, 0.f, 0.f}, paper);
  const Traced t(quads);
  for (const float height : {0.f, 2e-4f}) {
    const auto at = place_sensor(t.geometry, t.rays, {3.f, height, 3.f}, kUp);
    ASSERT_TRUE(at.triangle.valid());
    EXPECT_EQ(t.geometry.materials[at.triangle], paper);
  }
  // 0.6 mm apart they are two surfaces, each with its own light.
  QuadScene apart = room();
  apart.quad({2.f, 6e-4f, 2.f}, {0.f, 0.f, 4.f}, {4.f, 0.f, 0.f}, apart.material(0.8f));
  const Traced two(apart);
  EXPECT_EQ(place_sensor(two.geometry, two.rays, {3.f, 0.f, 3.f}, kUp).position.y, 0.f);
}

TEST(SensorPlacement, FarFromAnySurfaceASensorHangsInTheAir) {
  const Traced t(room());
  const Vec3 slanted = glm::normalize(Vec3(1.f, 2.f, 3.f));
  const auto at = place_sensor(t.geometry, t.rays, {3.f, 0.01f, 4.f}, slanted);
  EXPECT_FALSE(at.triangle.valid());
  EXPECT_EQ(at.position, Vec3(3.f, 0.01f, 4.f));
  EXPECT_EQ(at.normal, slanted);
}

TEST(SensorPlacement, APaneOfGlassIsASurfaceToo) {
  QuadScene quads = room();
  quads.quad({2.f, 5.f, 2.f}, {0.f, 0.f, 4.f}, {4.f, 0.f, 0.f}, quads.pane(0.05f));
  const Traced t(quads);
  EXPECT_TRUE(place_sensor(t.geometry, t.rays, {3.f, 5.f, 3.f}, kUp).triangle.valid());
}

TEST(ClosestBarycentric, AgreesWithASearchOverTheTriangle) {
  const Vec3 a(0.f), b(2.f, 0.f, 0.f), c(0.5f, 1.f, 0.f);
  for (int k = 0; k < 200; ++k) {
    const Vec3 p(4.f * to_unit_float(hash(k, 1)) - 1.f, 3.f * to_unit_float(hash(k, 2)) - 1.f,
                 to_unit_float(hash(k, 3)) - 0.5f);
    const Vec2 w = closest_barycentric(p, a, b, c);
    ASSERT_GE(std::min({w.x, w.y, 1.f - w.x - w.y}), -1e-6f);
    const float found = glm::distance(p, a + w.x * (b - a) + w.y * (c - a));
    float searched = kInfinity;
    for (int i = 0; i <= 100; ++i)
      for (int j = 0; i + j <= 100; ++j) {
        const Vec2 s(static_cast<float>(i) / 100.f, static_cast<float>(j) / 100.f);
        searched = std::min(searched, glm::distance(p, a + s.x * (b - a) + s.y * (c - a)));
      }
    EXPECT_LE(found, searched + 1e-5f);
    EXPECT_GE(found, searched - 0.03f);  // spacing of the search
  }
}

}  // namespace
}  // namespace halflight
