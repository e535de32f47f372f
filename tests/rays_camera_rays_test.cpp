#include <gtest/gtest.h>

#include "halflight/rays/automatic_view.h"
#include "halflight/rays/camera_rays.h"
#include "halflight/rays/path_traced_image.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;
using testing::Traced;

TEST(CameraRays, CentreLooksForwardAndBordersSpanTheFieldOfView) {
  PlacedCamera camera;
  camera.position = {1.f, 2.f, 3.f};
  camera.vertical_fov = kPi / 2.f;
  const CameraRays rays(camera, 200, 100);
  const auto near = [](const Vec3& a, const Vec3& b) { return glm::distance(a, b) < 1e-6f; };
  EXPECT_TRUE(near(rays.through({100.f, 50.f}).direction, {0.f, 0.f, -1.f}));
  EXPECT_TRUE(near(rays.through({100.f, 0.f}).direction, glm::normalize(Vec3(0.f, 1.f, -1.f))));
  EXPECT_TRUE(near(rays.through({200.f, 50.f}).direction, glm::normalize(Vec3(2.f, 0.f, -1.f))));
  EXPECT_EQ(rays.through({7.f, 7.f}).origin, camera.position);
}

TEST(CameraRays, OrthographicRaysAreParallelAndSpanTheHeight) {
  PlacedCamera camera;
  camera.perspective = false;
  camera.half_height = 3.f;
  const CameraRays rays(camera, 100, 100);
  EXPECT_EQ(rays.through({0.f, 0.f}).direction, camera.forward);
  EXPECT_NEAR(glm::distance(rays.through({0.f, 0.f}).origin, Vec3(-3.f, 3.f, 0.f)), 0.f, 1e-6f);
}

TEST(CameraRays, LookingAlongUpStillGivesAPicture) {
  PlacedCamera camera;
  camera.forward = camera.up;
  const Vec3 d = CameraRays(camera, 10, 10).through({1.f, 9.f}).direction;
  EXPECT_TRUE(is_finite(d));
  EXPECT_NEAR(glm::length(d), 1.f, 1e-5f);
}

TEST(PathTracedImage, ShowsEmittersSkyAndReflectedLightWithTheirRadiance) {
  QuadScene quads;
  quads.scene.sky = Rgb(0.5f);
  quads.quad({-3.f, -1.f, -5.f}, {2.f, 0.f, 0.f}, {0.f, 2.f, 0.f}, quads.material(0.f, 7.f));
  quads.quad({-1.f, -1.f, -5.f}, {2.f, 0.f, 0.f}, {0.f, 2.f, 0.f}, quads.material(0.8f));
  const Traced t(quads);
  PlacedCamera camera;
  const CameraRays rays(camera, 60, 20);
  const Image image = path_traced_image(t.tracer, rays, 60, 20, 64, 1, Progress());
  EXPECT_EQ(image.at(22, 10), Rgb(7.f));  // left of the centre: the lamp
  EXPECT_NEAR(image.at(30, 10).g, 0.8f * 0.5f,
              1e-5f);                      // sky light on white, coplanar with the lamp
  EXPECT_EQ(image.at(55, 10), Rgb(0.5f));  // right: the sky
}

TEST(AutomaticView, LooksIntoALitRoomFromInside) {
  QuadScene quads;
  quads.box(Vec3(0.f), Vec3(4.f, 3.f, 6.f), quads.material(0.5f), true);
  quads.quad({1.f, 2.9f, 2.f}, {1.f, 0.f, 0.f}, {0.f, 0.f, 1.f}, quads.material(0.f, 10.f));
  const Traced t(quads);
  const PlacedCamera camera = automatic_view(t.tracer);
  EXPECT_TRUE(t.geometry.bounds.contains(camera.position));
  const CameraRays rays(camera, 16, 16);
  const Image image = path_traced_image(t.tracer, rays, 16, 16, 4, 1, Progress());
  int lit = 0;
  for (const Rgb& c : image.pixels) lit += max_component(c) > 0.f;
  EXPECT_GT(lit, 250);
}

}  // namespace
}  // namespace halflight
