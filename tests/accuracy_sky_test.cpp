// Light of a uniform sky (CIE sky type 5) through unglazed openings into a black room of 4 x 4 x 3
// m: E / (pi L) is the configuration factor of the part of the opening that shows sky. After CIE
// 171:2006, 5.9, 5.11, 5.13 and 5.14; floor points, which see none of the ground.
#include "accuracy_case.h"

namespace halflight {
namespace {

using namespace testing;

constexpr Point kAbove{0, 1, 0};
constexpr double kSky = 50.0;

class AccuracySky : public AccuracyCase {
 protected:
  // Walls, floor, and a ceiling with a square hole in its middle; an opening of 4 m leaves none.
  QuadScene roof_opening(float side, float reflectance = 0.f) const {
    QuadScene scene;
    const MaterialId black = scene.material(reflectance);
    walls(scene, black);
    scene.quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, black);
    const float rim = 0.5f * (4.f - side);
    if (rim > 0.f) {
      scene.quad({0, 3, 0}, {4, 0, 0}, {0, 0, rim}, black);
      scene.quad({0, 3, 4.f - rim}, {4, 0, 0}, {0, 0, rim}, black);
      scene.quad({0, 3, rim}, {rim, 0, 0}, {0, 0, side}, black);
      scene.quad({4.f - rim, 3, rim}, {rim, 0, 0}, {0, 0, side}, black);
    }
    scene.scene.sky = Rgb(static_cast<float>(kSky));
    return scene;
  }
  // The wall at z = 0 has a window of 2 x 1 m over a sill of 1 m.
  QuadScene facade_opening() const {
    QuadScene scene;
    const MaterialId black = scene.material(0.f);
    walls(scene, black);
    scene.quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, black);
    scene.quad({0, 0, 0}, {4, 0, 0}, {0, 1, 0}, black);
    scene.quad({0, 2, 0}, {4, 0, 0}, {0, 1, 0}, black);
    scene.quad({0, 1, 0}, {1, 0, 0}, {0, 1, 0}, black);
    scene.quad({3, 1, 0}, {1, 0, 0}, {0, 1, 0}, black);
    scene.scene.sky = Rgb(static_cast<float>(kSky));
    return scene;
  }
  // On the floor, away from the window; of its heights only those between `low` and `high` of the
  // point show sky.
  template <class Low, class High>
  static std::vector<KnownLight> floor_points(const Low& low, const High& high) {
    std::vector<KnownLight> points;
    for (int i = 0; i < 7; ++i) {
      const Point x(1.3 + 0.2 * i, 0, 0.5 + 0.5 * i);
      const double y0 = std::max(1.0, low(x.z)), y1 = std::min(2.0, high(x.z));
      if (y1 - y0 < 0.1) continue;
      const auto part = rectangle({1, y0, 0}, {2, 0, 0}, {0, y1 - y0, 0});
      points.push_back({x, kAbove, kSky * kPiExact * configuration_factor(x, kAbove, part)});
    }
    return points;
  }

 private:
  static void walls(QuadScene& scene, MaterialId material) {
    scene.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, material);
    scene.quad({0, 0, 4}, {0, 3, 0}, {4, 0, 0}, material);
    scene.quad({0, 0, 0}, {0, 3, 0}, {0, 0, 4}, material);
    scene.quad({4, 0, 0}, {0, 0, 4}, {0, 3, 0}, material);
  }
};

TEST_F(AccuracySky, ThroughTheRoof) {
  for (const double side : {1.0, 4.0}) {
    const double rim = 0.5 * (4.0 - side);
    const auto opening = rectangle({rim, 3, rim}, {side, 0, 0}, {0, 0, side});
    std::vector<KnownLight> points;
    for (int i = 0; i < 7; ++i) {
      const Point floor(0.3 + 0.55 * i, 0, 0.5 + 0.5 * i), wall(0, 0.2 + 0.35 * i, 0.4 + 0.5 * i);
      points.push_back({floor, kAbove, configuration_factor(floor, kAbove, opening)});
      points.push_back({wall, {1, 0, 0}, configuration_factor(wall, {1, 0, 0}, opening)});
    }
    for (KnownLight& k : points) k.irradiance *= kSky * kPiExact;
    expect_at_points(fmt::format("5.9 sky through a roof opening of {} x {} m", side, side),
                     roof_opening(static_cast<float>(side)), points, 0.05);
  }
}

constexpr auto kNoLimitBelow = [](double) { return 0.0; };
constexpr auto kNoLimitAbove = [](double) { return 3.0; };

TEST_F(AccuracySky, ThroughTheFacade) {
  expect_at_points("5.11 sky through a facade opening", facade_opening(),
                   floor_points(kNoLimitBelow, kNoLimitAbove), 0.05);
}

// A canopy of 1 m over the window, so wide that it ends nowhere within view.
TEST_F(AccuracySky, UnderAHorizontalMask) {
  QuadScene scene = facade_opening();
  scene.quad({-40, 2, -1}, {80, 0, 0}, {0, 0, 1}, scene.material(0.f));
  expect_at_points("5.13 sky under a horizontal mask", scene,
                   floor_points(kNoLimitBelow, [](double z) { return 2.0 * z / (z + 1.0); }), 0.05);
}

// A wall 3.5 m high and 6 m away.
TEST_F(AccuracySky, OverAVerticalMask) {
  QuadScene scene = facade_opening();
  scene.quad({-60, 0, -6}, {120, 0, 0}, {0, 3.5f, 0}, scene.material(0.f));
  expect_at_points("5.14 sky over a vertical mask", scene,
                   floor_points([](double z) { return 3.5 * z / (z + 6.0); }, kNoLimitAbove), 0.05);
}

// What comes through the opening, pi L A, falls on the floor and the four walls, by symmetry all
// alike; behind a pane, its transmittance times that.
TEST_F(AccuracySky, FluxThroughTheRoofArrivesInTheRoom) {
  const GaussRule<12> rule;
  std::vector<KnownLight> points;
  std::vector<double> areas;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t k = 0; k < 12; ++k) {
      const double w = rule.weight[i] * rule.weight[k];
      points.push_back({{4.0 * rule.at[i], 0, 4.0 * rule.at[k]}, kAbove, 0.0});
      areas.push_back(16.0 * w);
      points.push_back({{0, 3.0 * rule.at[i], 4.0 * rule.at[k]}, {1, 0, 0}, 0.0});
      areas.push_back(4.0 * 12.0 * w);
    }
  for (const float opacity : {0.f, 0.3f}) {
    QuadScene scene = roof_opening(1.f);
    if (opacity > 0.f) scene.quad({1.5f, 3, 1.5f}, {1, 0, 0}, {0, 0, 1}, scene.pane(opacity));
    const std::vector<double> irradiance = solved(scene, points);
    double flux = 0.0;
    for (std::size_t i = 0; i < irradiance.size(); ++i) flux += areas[i] * irradiance[i];
    const double through = 1.0 - static_cast<double>(opacity);
    expect_value(opacity > 0.f ? "5.4 flux through a pane of transmittance 0.7"
                               : "5.4 flux through an unglazed opening",
                 "flux on floor and walls", flux, kPiExact * kSky * through, 0.01);
  }
}

}  // namespace
}  // namespace halflight
