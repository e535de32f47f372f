// Direct light on black surfaces: panels, a panel seen through an opening, punctual lights.
// After CIE 171:2006, 5.2 and 5.3.
#include "accuracy_case.h"

namespace halflight {
namespace {

using namespace testing;

constexpr Point kAbove{0, 1, 0};

class AccuracyDirect : public AccuracyCase {};

TEST_F(AccuracyDirect, TabledCornerFormulasAreLambertsSum) {
  const double a = 1.3, b = 0.4, c = 0.7;
  EXPECT_NEAR(configuration_factor({0, 0, 0}, kAbove, rectangle({0, c, 0}, {a, 0, 0}, {0, 0, b})),
              factor_to_parallel_corner(a, b, c), 1e-12);
  EXPECT_NEAR(configuration_factor({0, 0, 0}, kAbove, rectangle({c, 0, 0}, {0, a, 0}, {0, 0, b})),
              factor_to_upright_corner(a, b, c), 1e-12);
}

// A room of 4 x 4 x 3 m, a panel of 1 x 1 m in its ceiling.
TEST_F(AccuracyDirect, PanelInTheCeiling) {
  QuadScene scene;
  scene.box({0, 0, 0}, {4, 3, 4}, scene.material(0.f), true);
  scene.quad({1.5f, 2.999f, 1.5f}, {1, 0, 0}, {0, 0, 1}, scene.material(0.f, 100.f));
  const auto panel = rectangle({1.5, 2.999, 1.5}, {1, 0, 0}, {0, 0, 1});
  std::vector<KnownLight> floor, wall;
  for (int i = 0; i < 8; ++i) {
    const double t = 0.25 + 0.5 * i;
    const Point on_floor(t, 0, 0.25 + 0.4 * i), on_wall(0, 0.3 * i + 0.2, t);
    floor.push_back(
        {on_floor, kAbove, 100.0 * kPiExact * configuration_factor(on_floor, kAbove, panel)});
    wall.push_back(
        {on_wall, {1, 0, 0}, 100.0 * kPiExact * configuration_factor(on_wall, {1, 0, 0}, panel)});
  }
  expect_at_points("5.3 area source, floor", scene, floor, 0.01);
  expect_at_points("5.3 area source, wall", scene, wall, 0.01);
}

// A panel of 4 x 4 m behind a plate with an opening of 1 x 1 m: a point sees the panel's rectangle
// that the opening, projected onto it, leaves.
TEST_F(AccuracyDirect, PanelThroughAnOpening) {
  QuadScene scene;
  const MaterialId black = scene.material(0.f);
  scene.box({0, 0, 0}, {4, 4, 4}, black, true);
  scene.quad({0, 3.99f, 0}, {4, 0, 0}, {0, 0, 4}, scene.material(0.f, 10.f));
  const float plate = 3.f;
  scene.quad({0, plate, 0}, {4, 0, 0}, {0, 0, 1.5f}, black);
  scene.quad({0, plate, 2.5f}, {4, 0, 0}, {0, 0, 1.5f}, black);
  scene.quad({0, plate, 1.5f}, {1.5f, 0, 0}, {0, 0, 1}, black);
  scene.quad({2.5f, plate, 1.5f}, {1.5f, 0, 0}, {0, 0, 1}, black);
  std::vector<KnownLight> points;
  for (int i = 0; i < 8; ++i) {
    const Point x(0.3 + 0.45 * i, 0, 0.5 + 0.4 * i);
    const double scale = 3.99 / 3.0;
    const auto seen = [&](double at, double through) {
      return std::clamp(at + scale * (through - at), 0.0, 4.0);
    };
    const double x0 = seen(x.x, 1.5), x1 = seen(x.x, 2.5), z0 = seen(x.z, 1.5), z1 = seen(x.z, 2.5);
    const auto part = rectangle({x0, 3.99, z0}, {x1 - x0, 0, 0}, {0, 0, z1 - z0});
    points.push_back({x, kAbove, 10.0 * kPiExact * configuration_factor(x, kAbove, part)});
  }
  expect_at_points("5.3 area source through an opening", scene, points, 0.05);
}

// 1,000 cd in all directions at 3 m: I cos / d^2.
TEST_F(AccuracyDirect, PointSource) {
  QuadScene scene;
  scene.box({0, 0, 0}, {4, 4, 4}, scene.material(0.f), true);
  Light lamp;
  lamp.intensity = Rgb(1000.f);
  scene.light_shining_down(lamp, {2, 3, 2});
  std::vector<KnownLight> points;
  const Point source(2, 3, 2);
  for (int i = 0; i < 8; ++i) {
    for (const auto& [x, n] : {std::pair(Point(0.25 + 0.5 * i, 0, 1.0 + 0.3 * i), kAbove),
                               std::pair(Point(0, 0.25 + 0.5 * i, 1.7), Point(1, 0, 0))}) {
      const Point to = source - x;
      const double d2 = glm::dot(to, to);
      points.push_back({x, n, 1000.0 * glm::dot(n, to) / (d2 * std::sqrt(d2))});
    }
  }
  expect_at_points("5.2 point source", scene, points, 0.001);
}

TEST_F(AccuracyDirect, SunThroughAnOpening) {
  QuadScene scene;
  const MaterialId black = scene.material(0.f);
  scene.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, black);
  scene.quad({0, 2, 0}, {4, 0, 0}, {0, 0, 1.5f}, black);
  scene.quad({0, 2, 2.5f}, {4, 0, 0}, {0, 0, 1.5f}, black);
  Light sun;
  sun.kind = Light::Kind::directional;
  sun.intensity = Rgb(10000.f);
  scene.light_shining_down(sun, {0, 9, 0});
  std::vector<KnownLight> lit;
  const double tilt = 0.6;
  for (const double z : {1.55, 1.8, 2.2, 2.45}) {
    lit.push_back({{2, 0, z}, kAbove, 10000.0});
    // In the air, tilted.
    lit.push_back({{1, 0.5, z}, {std::sin(tilt), std::cos(tilt), 0}, 10000.0 * std::cos(tilt)});
  }
  expect_at_points("directional light, cosine", scene, lit, 0.001);
  std::vector<KnownLight> dark;
  for (const double z : {0.3, 1.45, 2.55, 3.7}) dark.push_back({{2, 0, z}, kAbove, 0.0});
  for (const double e : solved(scene, dark)) EXPECT_EQ(e, 0.0);
}

}  // namespace
}  // namespace halflight
