// Blocker sizes of shapes whose widths are known.
#include <gtest/gtest.h>

#include "clustered_world.h"
#include "halflight/visibility/blocker_size.h"

namespace halflight {
namespace {

using testing::Dice;
using testing::ShapeScene;

const Vec3 kAlongZ(0, 0, 1);
const Frame kStraight{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Bounds3f kUnit{Vec3(-1.f, -1.f, -0.5f), Vec3(1.f, 1.f, 0.5f)};  // 2 x 2 seen along z

ClusterPicture picture(ShapeScene& shapes, const Bounds3f& box, const Vec3& direction = kAlongZ) {
  shapes.end_mesh();
  const World world(shapes.scene);
  std::vector<TriangleId> all;
  for (std::size_t i = 0; i < world.geometry.triangles.size(); ++i) all.emplace_back(i);
  return picture_cluster(world.scene, world.geometry, all, box, direction);
}

TEST(BlockerSize, OfASquareIsItsSide) {
  for (const float side : {0.2f, 0.5f, 1.13f, 1.9f}) {
    ShapeScene shapes;
    shapes.quad(Vec3(0.f), Vec3(0.5f * side, 0, 0), Vec3(0, 0.5f * side, 0));
    const ClusterPicture p = picture(shapes, kUnit);
    EXPECT_NEAR(p.blocked, side, p.pixel);
    EXPECT_NEAR(p.coverage, side * side / 4.f, 0.03f);
    // Beside it: a strip from the box's border to the square.
    EXPECT_NEAR(p.free, 1.f - 0.5f * side, p.pixel);
  }
}

TEST(BlockerSize, OfACubeIsItsEdgeFromAnywhereAlongAnAxis) {
  ShapeScene shapes;
  shapes.cube(Vec3(0.2f, 0.f, 0.f), kStraight, 0.8f);
  const Bounds3f box{Vec3(-1.f), Vec3(1.f)};
  for (int axis = 0; axis < 3; ++axis) {
    const ClusterPicture p = picture(shapes, box, picture_directions()[axis]);
    EXPECT_NEAR(p.blocked, 0.8f, p.pixel);
    EXPECT_NEAR(p.coverage, 0.16f, 0.02f);
  }
}

TEST(BlockerSize, OfSquaresThatTouchIsTheirUnion) {
  ShapeScene apart, behind;
  // Four squares of 0.5 at different depths: a square of 1 together, or with a gap of 0.4.
  for (const float x : {-1.f, 1.f})
    for (const float y : {-1.f, 1.f}) {
      behind.quad(Vec3(0.25f * x, 0.25f * y, 0.3f * x * y), Vec3(0.25f, 0, 0), Vec3(0, 0.25f, 0));
      apart.quad(Vec3(0.45f * x, 0.45f * y, 0.3f * x * y), Vec3(0.25f, 0, 0), Vec3(0, 0.25f, 0));
    }
  const ClusterPicture joined = picture(behind, kUnit), split = picture(apart, kUnit);
  EXPECT_NEAR(joined.blocked, 1.f, joined.pixel);
  EXPECT_NEAR(split.blocked, 0.5f, split.pixel);
}

TEST(BlockerSize, OfAHoleIsItsSide) {
  ShapeScene shapes;
  for (const float s : {-1.f, 1.f}) {
    shapes.quad(Vec3(0.65f * s, 0, 0), Vec3(0.35f, 0, 0), Vec3(0, 1, 0));
    shapes.quad(Vec3(0, 0.65f * s, 0.1f), Vec3(1, 0, 0), Vec3(0, 0.35f, 0));
  }
  const ClusterPicture p = picture(shapes, kUnit);
  EXPECT_NEAR(p.free, 0.6f, p.pixel);
  EXPECT_NEAR(p.blocked, 0.7f, p.pixel);
  EXPECT_FLOAT_EQ(p.blocker_size(), p.blocked);
}

TEST(BlockerSize, ClearPanesBlockNothing) {
  ShapeScene shapes;
  shapes.material().alpha_mode = AlphaMode::blend;
  shapes.material().alpha = 0.2f;
  shapes.quad(Vec3(0.f), Vec3(0.5f, 0, 0), Vec3(0, 0.5f, 0));
  const ClusterPicture p = picture(shapes, kUnit);
  EXPECT_EQ(p.blocked, 0.f);
  EXPECT_EQ(p.extinction, 0.f);
}

TEST(BlockerSize, WhatCoversItsBoxIsOpaque) {
  ShapeScene shapes;
  shapes.quad(Vec3(0.f), Vec3(1, 0, 0), Vec3(0, 1, 0));
  const ClusterPicture p = picture(shapes, kUnit);
  EXPECT_FLOAT_EQ(p.coverage, 1.f);
  EXPECT_LT(std::exp(-p.extinction * kUnit.extent().z), 2e-3f);
}

// The mean transmittance of parallel rays through the box is what its picture shows.
TEST(BlockerSize, CoverageExtinctionKeepsTheLightOfAnyCluster) {
  ShapeScene shapes;
  Dice dice(3);
  const Bounds3f box{Vec3(-1.f), Vec3(1.f)};
  for (int i = 0; i < 40; ++i)
    shapes.cube(dice.point_in({Vec3(-0.85f), Vec3(0.85f)}), kStraight, 0.3f);
  shapes.end_mesh();
  const World world(shapes.scene);
  for (int d = 0; d < kPictureDirections; ++d) {
    const Vec3 w = picture_directions()[d];
    std::vector<TriangleId> all;
    for (std::size_t i = 0; i < world.geometry.triangles.size(); ++i) all.emplace_back(i);
    const ClusterPicture p = picture_cluster(world.scene, world.geometry, all, box, w);
    const Frame f = Frame::from_normal(w);
    double exact = 0.0, medium = 0.0, rays = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 at = f.to_world({dice.between(-1.8f, 1.8f), dice.between(-1.8f, 1.8f), 0.f});
      float near = -4.f, far = 4.f;
      for (int axis = 0; axis < 3; ++axis) {
        const float slope = std::abs(w[axis]) < 1e-6f ? 1e-6f : w[axis];
        const float a = (box.lower[axis] - at[axis]) / slope;
        const float b = (box.upper[axis] - at[axis]) / slope;
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
      }
      if (far <= near) continue;
      rays += 1.0;
      exact += world.rays.transmittance(at - 4.f * w, at + 4.f * w);
      medium += std::exp(-p.extinction * (far - near));
    }
    EXPECT_NEAR(medium / rays, exact / rays, 0.02) << d;
    EXPECT_NEAR(p.coverage, 1.0 - exact / rays, 0.02) << d;
  }
}

TEST(BlockerSize, NearestDirectionIsTheOneAtTheLeastAngle) {
  for (int i = 0; i < kPictureDirections; ++i) {
    const Vec3 d = picture_directions()[i];
    EXPECT_EQ(nearest_picture_direction(3.f * d), i);
    EXPECT_EQ(nearest_picture_direction(-d + Vec3(0.05f, -0.03f, 0.02f)), i);
  }
}

}  // namespace
}  // namespace halflight
