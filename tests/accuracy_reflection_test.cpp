// One diffuse reflection: a floor tile lit evenly from above lights black walls and what hangs over
// it; E / (rho E_v) is its configuration factor, or that of the part that an obstruction leaves.
// After CIE 171:2006, 5.6 and 5.7, whose table 19 (obstructed, vertical points) is known to be
// wrong: what is expected here comes from the formulas.
#include "accuracy_case.h"

namespace halflight {
namespace {

using namespace testing;

constexpr double kReflectance = 0.6, kLux = 1000.0;

class AccuracyReflection : public AccuracyCase {
 protected:
  // A tile of the given side, its edge at the foot of a wall at z = 0, in light straight from above
  // that grazes the wall.
  static QuadScene tile(float side) {
    QuadScene scene;
    scene.quad({-0.5f * side, 0, 0}, {0, 0, side}, {side, 0, 0},
               scene.material(static_cast<float>(kReflectance)));
    scene.quad({-2, 0, 0}, {4, 0, 0}, {0, 3, 0}, scene.material(0.f));
    Light sun;
    sun.kind = Light::Kind::directional;
    sun.intensity = Rgb(static_cast<float>(kLux));
    scene.light_shining_down(sun, {0, 5, 0});
    return scene;
  }
  static KnownLight known(const Point& x, const Point& n, const std::vector<Point>& part) {
    return {x, n, kReflectance * kLux * configuration_factor(x, n, part)};
  }
};

TEST_F(AccuracyReflection, TileLightsWallAndCeiling) {
  for (const double side : {0.5, 4.0}) {
    const auto whole = rectangle({-0.5 * side, 0, 0}, {side, 0, 0}, {0, 0, side});
    std::vector<KnownLight> points;
    for (int i = 0; i < 7; ++i) {
      points.push_back(known({0.2 * i - 0.6, 0.2 + 0.4 * i, 0}, {0, 0, 1}, whole));
      points.push_back(known({0.3 * i - 1.0, 3, 0.25 + 0.5 * i}, {0, -1, 0}, whole));
    }
    expect_at_points(fmt::format("5.6 reflection of a tile of {} x {} m", side, side),
                     tile(static_cast<float>(side)), points, 0.03);
  }
}

// A black screen parallel to the wall, 1 m high and wider than the tile: points of the wall see
// what is before it, and above it what is far enough behind.
TEST_F(AccuracyReflection, TileBehindAScreen) {
  const double at = 1.5, height = 1.0;
  QuadScene scene = tile(4.f);
  scene.quad({-30, 0, static_cast<float>(at)}, {60, 0, 0}, {0, static_cast<float>(height), 0},
             scene.material(0.f));
  std::vector<KnownLight> points;
  for (const double y : {0.3, 0.8, 1.3, 1.8, 2.3, 2.8}) {
    const Point x(0.3, y, 0), n(0, 0, 1);
    KnownLight k = known(x, n, rectangle({-2, 0, 0}, {4, 0, 0}, {0, 0, at}));
    const double behind = y > height ? at * y / (y - height) : 4.0;
    if (behind < 4.0)
      k.irradiance +=
          known(x, n, rectangle({-2, 0, behind}, {4, 0, 0}, {0, 0, 4.0 - behind})).irradiance;
    points.push_back(k);
  }
  expect_at_points("5.7 reflection past an obstruction, wall", scene, points, 0.03);

  // Points over the tile, facing down, at the height of the screen's double.
  std::vector<KnownLight> over;
  for (const double z : {0.25, 0.75, 1.25, 2.0, 3.0, 3.75}) {
    const Point x(0.3, 2.0, z), n(0, -1, 0);
    // The screen hides from its foot to as far beyond as the point is before it.
    const double shadow = at + (at - z);
    const double from = std::clamp(std::min(at, shadow), 0.0, 4.0),
                 to = std::clamp(std::max(at, shadow), 0.0, 4.0);
    KnownLight k = known(x, n, rectangle({-2, 0, 0}, {4, 0, 0}, {0, 0, 4}));
    k.irradiance -= known(x, n, rectangle({-2, 0, from}, {4, 0, 0}, {0, 0, to - from})).irradiance;
    over.push_back(k);
  }
  expect_at_points("5.7 reflection past an obstruction, ceiling", scene, over, 0.03);
}

}  // namespace
}  // namespace halflight
