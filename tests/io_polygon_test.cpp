#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "halflight/io/polygon.h"

namespace halflight {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles cut(const std::vector<Vec3>& corners) {
  Triangles triangles;
  triangulate_polygon(corners, triangles);
  return triangles;
}

Vec3 newell(const std::vector<Vec3>& corners) {
  Vec3 sum(0.f);
  for (std::size_t i = 0; i < corners.size(); ++i)
    sum += glm::cross(corners[i], corners[(i + 1) % corners.size()]);
  return 0.5f * sum;
}

// Triangles of the right total area, each wound like the polygon, do not overlap nor stick out.
void expect_exact_cover(const std::vector<Vec3>& corners) {
  const Triangles triangles = cut(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  const Vec3 whole = newell(corners);
  float area = 0.f;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 normal = 0.5f * glm::cross(corners[b] - corners[a], corners[c] - corners[a]);
    EXPECT_GE(glm::dot(normal, whole), 0.f);
    area += glm::length(normal);
  }
  EXPECT_NEAR(area, glm::length(whole), 1e-4f * glm::length(whole));
}

TEST(Polygon, ConcaveShapesAreCoveredOnce) {
  expect_exact_cover({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}});  // L
  expect_exact_cover({{0, 0, 0}, {4, 0, 1}, {1, 1, 0.5f}, {0, 4, 1}});  // arrow, bent a little
  // Clockwise seen from +z: the triangles are clockwise too.
  expect_exact_cover({{0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0, 0}, {0, 0, 0}});
}

TEST(Polygon, CornersOnStraightEdgesStayConnected) {
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  expect_exact_cover(square);
  for (const auto& [a, b, c] : cut(square))
    EXPECT_GT(glm::length(glm::cross(square[b] - square[a], square[c] - square[a])), 0.f);
}

TEST(Polygon, AHoleOnABridgeStaysOpen) {
  // A 4 x 4 square with a 2 x 2 hole, joined by a slit that is walked in both directions.
  expect_exact_cover({{0, 0, 0},
                      {4, 0, 0},
                      {4, 4, 0},
                      {0, 4, 0},
                      {0, 0, 0},
                      {1, 1, 0},
                      {1, 3, 0},
                      {3, 3, 0},
                      {3, 1, 0},
                      {1, 1, 0}});
}

TEST(Polygon, RandomStarsInAnyPlaneAreCoveredOnce) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> radius(0.2f, 1.f), any(-1.f, 1.f);
  for (int trial = 0; trial < 200; ++trial) {
    const Frame frame = Frame::from_normal(glm::normalize(Vec3(any(random), any(random), 0.3f)));
    const int n = 5 + trial % 60;
    std::vector<Vec3> star;
    for (int i = 0; i < n; ++i) {
      const float angle = 2.f * kPi * static_cast<float>(i) / static_cast<float>(n);
      star.push_back(frame.to_world(radius(random) * Vec3(std::cos(angle), std::sin(angle), 0.f)));
    }
    expect_exact_cover(star);
  }
}

TEST(Polygon, ShapesWithoutAreaStillGiveTheirNumberOfTriangles) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}).size(), 3u);
  EXPECT_EQ(cut(std::vector<Vec3>(9, Vec3(1.f))).size(), 7u);
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);  // crosses itself
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}}).size(), 0u);
}

}  // namespace
}  // namespace halflight
