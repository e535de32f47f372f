#include "halflight/scene/order_in_space.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <tuple>

namespace halflight {
namespace {

using Corner = std::tuple<float, float, float, float, float>;  // position, and what goes with it
using Triangle = std::array<Corner, 3>;

// Loose triangles strewn over a cube, in no order; each vertex carries its number along.
Scene strewn(std::size_t triangles) {
  std::mt19937 dice(1);
  std::uniform_real_distribution<float> in_cube(0.f, 1.f), nearby(-0.01f, 0.01f);
  Primitive p;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 at(in_cube(dice), in_cube(dice), in_cube(dice));
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<float>(p.positions.size());
      p.positions.push_back(at + Vec3(nearby(dice), nearby(dice), nearby(dice)));
      p.normals.emplace_back(number, 0.f, 0.f);
      p.uvs[0].emplace_back(number, -number);
    }
    p.triangles.push_back({3 * i, 3 * i + 2, 3 * i + 1});
  }
  Scene scene;
  scene.meshes.push_back({"strewn", {std::move(p)}});
  return scene;
}

Primitive& primitive_of(Scene& scene) { return scene.meshes.back().primitives.front(); }

// In the order of their corners in space.
std::vector<Triangle> triangles_of(const Primitive& p) {
  std::vector<Triangle> triangles;
  for (const auto& corners : p.triangles) {
    Triangle& t = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 at = p.positions[corners[k]];
      t[k] = {at.x, at.y, at.z, p.normals[corners[k]].x, p.uvs[0][corners[k]].y};
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

float mean_step(const Primitive& p) {
  float sum = 0.f;
  for (std::size_t i = 1; i < p.triangles.size(); ++i)
    sum += glm::distance(p.positions[p.triangles[i - 1][0]], p.positions[p.triangles[i][0]]);
  return sum / static_cast<float>(p.triangles.size() - 1);
}

TEST(OrderInSpace, KeepsEveryTriangleWithWhatItsVerticesCarry) {
  Scene scene = strewn(40'000);
  const std::vector<Triangle> before = triangles_of(primitive_of(scene));
  order_in_space(scene);
  EXPECT_TRUE(before == triangles_of(primitive_of(scene)));
}

TEST(OrderInSpace, BringsNeighboursTogether) {
  Scene scene = strewn(40'000);
  const float before = mean_step(primitive_of(scene));
  order_in_space(scene);
  const Primitive& p = primitive_of(scene);
  EXPECT_LT(mean_step(p), 0.1f * before);
  for (std::uint32_t i = 0; i < p.triangles.size(); ++i)  // their vertices, too
    ASSERT_THAT(p.triangles[i], testing::ElementsAre(3 * i, 3 * i + 1, 3 * i + 2));
}

TEST(OrderInSpace, LeavesSmallPrimitivesAsTheyAre) {
  Scene scene = strewn(1'000);
  const auto before = primitive_of(scene).triangles;
  order_in_space(scene);
  EXPECT_EQ(before, primitive_of(scene).triangles);
}

TEST(OrderInSpace, KeepsVerticesThatAreNowhereOrUnused) {
  Scene scene = strewn(40'000);
  Primitive& p = primitive_of(scene);
  p.positions[7].x = std::numeric_limits<float>::quiet_NaN();
  p.positions[50].y = kInfinity;
  p.positions[90] = Vec3(3e38f);
  for (int i = 0; i < 5; ++i) {
    p.positions.emplace_back(8.f);
    p.normals.emplace_back(0.f);
    p.uvs[0].emplace_back(0.f);
  }
  order_in_space(scene);
  EXPECT_EQ(p.positions.size(), 120'005u);
  EXPECT_EQ(std::count_if(p.positions.begin(), p.positions.end(),
                          [](const Vec3& v) { return !is_finite(v); }),
            2);
  EXPECT_THAT(p.positions.back(), Vec3(8.f));
}

}  // namespace
}  // namespace halflight
