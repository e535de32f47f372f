// Sequences of sample points, and what they are warped to.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::uint32_t kPoints = 1024;

// Boxes of [0, 1)^4 hold their share of the pairs, as they would not if the second point of a pair
// followed from the first.
TEST(CompanionSequence, PairsFillFourDimensions) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Vec2 shift_a = random_shift(seed), shift_b = random_shift(hash(seed, 9));
    std::array<int, 16> in_box{};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Vec2 a = r2_sequence(i, shift_a), b = companion_sequence(i, shift_b);
      ++in_box[(a.x < 0.5f) + 2 * (a.y < 0.5f) + 4 * (b.x < 0.5f) + 8 * (b.y < 0.5f)];
    }
    const auto [least, most] = std::minmax_element(in_box.begin(), in_box.end());
    EXPECT_GT(*least, kPoints / 16 * 3 / 4);
    EXPECT_LT(*most, kPoints / 16 * 5 / 4);
  }
}

TEST(CompanionSequence, AnyPrefixIsSpread) {
  for (std::uint32_t n : {16u, 64u, 256u}) {
    std::array<std::uint32_t, 4> in_box{};
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec2 u = companion_sequence(i);
      ++in_box[(u.x < 0.5f) + 2 * (u.y < 0.5f)];
    }
    for (const std::uint32_t count : in_box) {
      EXPECT_GE(count, n / 4 - n / 8);
      EXPECT_LE(count, n / 4 + n / 8);
    }
  }
}

// Means of a direction's coordinates and of their squares, over a whole sequence.
struct Moments {
  Vec3 mean{0.f}, squares{0.f};
};
template <class Warp>
Moments moments_of(const Warp& warp) {
  Moments moments;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const Vec3 w = warp(r2_sequence(i));
    EXPECT_NEAR(glm::length(w), 1.f, 1e-5f);
    moments.mean += w / static_cast<float>(kPoints);
    moments.squares += w * w / static_cast<float>(kPoints);
  }
  return moments;
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], 5e-3f) << axis;
}

TEST(Warps, DirectionsOfCosineDensityMeanTwoThirdsOfTheNormal) {
  const Moments m = moments_of(cosine_hemisphere);
  expect_near(m.mean, {0.f, 0.f, 2.f / 3.f});
  expect_near(m.squares, {0.25f, 0.25f, 0.5f});
}

TEST(Warps, DirectionsOnTheSphereFavourNone) {
  const Moments m = moments_of(uniform_sphere);
  expect_near(m.mean, Vec3(0.f));
  expect_near(m.squares, Vec3(1.f / 3.f));
}

// Over a triangle each weight means 1/3 and its square 1/6.
TEST(Warps, PointsOnATriangleFavourNoCorner) {
  Vec3 mean(0.f), squares(0.f);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const Vec2 b = uniform_triangle(r2_sequence(i));
    const Vec3 weights(1.f - b.x - b.y, b.x, b.y);
    EXPECT_GE(std::min({weights.x, weights.y, weights.z}), 0.f);
    mean += weights / static_cast<float>(kPoints);
    squares += weights * weights / static_cast<float>(kPoints);
  }
  expect_near(mean, Vec3(1.f / 3.f));
  expect_near(squares, Vec3(1.f / 6.f));
}

}  // namespace
}  // namespace halflight
