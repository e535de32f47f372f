#include "halflight/rays/spherical_triangle.h"

#include <gtest/gtest.h>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

TEST(SphericalTriangle, OctantCoversAnEighthOfTheSphere) {
  const SphericalTriangle octant({Vec3(1, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 3)});
  EXPECT_NEAR(octant.solid_angle(), 0.5f * kPi, 1e-5f);
}

TEST(SphericalTriangle, DirectionsAreUniformInSolidAngle) {
  // The mean of a function over directions equals its integral over the triangle / solid angle:
  // of cos about z over the octant, pi / 4 / (pi / 2).
  const SphericalTriangle octant({Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
  Vec3 mean(0.f);
  constexpr std::uint32_t kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec3 w = octant.direction(r2_sequence(i));
    EXPECT_NEAR(glm::length(w), 1.f, 1e-4f);
    EXPECT_GE(std::min({w.x, w.y, w.z}), -1e-4f);
    mean += w / static_cast<float>(kCount);
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mean[axis], 0.5f, 2e-3f);
}

TEST(SphericalTriangle, OfTheSizeOfALampAcrossTheRoomStaysInside) {
  const std::array<Vec3, 3> corners{Vec3(0.1f, 3.f, 0.f), Vec3(0.2f, 3.f, 0.05f),
                                    Vec3(0.1f, 3.f, 0.15f)};
  const SphericalTriangle lamp(corners);
  EXPECT_GT(lamp.solid_angle(), 3e-4f);
  for (std::uint32_t i = 0; i < 256; ++i) {
    const Vec3 w = lamp.direction(r2_sequence(i));
    const Vec3 y = w * (3.f / w.y);
    EXPECT_GE(y.x, 0.1f - 1e-3f);
    EXPECT_GE(y.z, -1e-3f);
    EXPECT_LE(y.z, 0.15f + 1e-3f);
  }
}

TEST(SphericalTriangle, DegenerateOnesCoverNothing) {
  EXPECT_EQ(SphericalTriangle({Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)}).solid_angle(), 0.f);
}

TEST(SampleBilinear, DensityIsThatOfTheSamples) {
  // The mean of 1 / density over the samples is the area of the square.
  const std::array<float, 4> weights{0.1f, 1.f, 2.f, 0.5f};
  float area = 0.f, mean_x = 0.f;
  constexpr std::uint32_t kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const WarpedPoint p = sample_bilinear(r2_sequence(i), weights);
    area += 1.f / p.density / static_cast<float>(kCount);
    mean_x += p.u.x / p.density / static_cast<float>(kCount);
  }
  EXPECT_NEAR(area, 1.f, 5e-3f);
  EXPECT_NEAR(mean_x, 0.5f, 5e-3f);
}

}  // namespace
}  // namespace halflight
