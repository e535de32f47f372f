// The furnace: where every surface of a closed box emits L and reflects rho, B = pi L / (1 - rho)
// everywhere, whatever stands inside.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "halflight/scene/procedural/furnace.h"
#include "solved_scene.h"

namespace halflight {
namespace {

constexpr float kReflectance = 0.6f;
constexpr float kExpected = kPi / (1.f - kReflectance);  // E = B

class Furnace : public ::testing::TestWithParam<std::tuple<LinkMaker, int>> {
 protected:
  LinkMaker links() const { return std::get<0>(GetParam()); }
  // Rays keep rows exact. Refined links keep their estimated error only, and in a furnace the
  // errors of all links point the same way.
  float tolerance() const { return links() == LinkMaker::sampled ? 0.005f : 0.03f; }
  // Among cubes, direct light is read by 16 to 64 rays to each partly hidden triangle.
  float tolerance_at_sensors() const {
    if (links() == LinkMaker::refined) return 0.15f;
    return std::get<1>(GetParam()) == 0 ? 0.03f : 0.15f;
  }

  SolverState solved() const {
    FurnaceParameters furnace;
    furnace.reflectance = kReflectance;
    furnace.boxes = std::get<1>(GetParam());
    return testing::solve(furnace_scene(furnace), testing::options_of(links(), 0.2f, 0.02f));
  }
};

TEST_P(Furnace, EverySensorReadsTheSameLight) {
  const SolverState state = solved();
  const auto irradiance = testing::read_irradiance(state, scatter_points(state, 200));
  EXPECT_NEAR(testing::mean(irradiance) / kExpected, 1.f, tolerance());
  for (const float e : irradiance) EXPECT_NEAR(e / kExpected, 1.f, tolerance_at_sensors());
}

TEST_P(Furnace, EverySurfaceHasTheSameRadiosityOnTheMean) {
  const SolverState state = solved();
  EXPECT_NEAR(mean_irradiance(state) / kExpected, 1.f, tolerance());
  EXPECT_NEAR(average(state.radiosity[state.tree.root()]) / kExpected, 1.f, tolerance());
}

TEST_P(Furnace, AbsorbsWhatItEmits) {
  const EnergyBalance balance = energy_balance(solved());
  EXPECT_NEAR(average(balance.absorbed) / average(balance.emitted), 1.f, tolerance());
}

INSTANTIATE_TEST_SUITE_P(Boxes, Furnace,
                         ::testing::Combine(::testing::Values(LinkMaker::refined,
                                                              LinkMaker::sampled),
                                            ::testing::Values(0, 27)),
                         [](const auto& test) {
                           const bool refined = std::get<0>(test.param) == LinkMaker::refined;
                           return std::string(refined ? "Refined" : "Sampled") +
                                  std::to_string(std::get<1>(test.param));
                         });

// Pale walls face to face send light to and fro for long; rows of more than 1 / reflectance would
// make it without end.
TEST(PaleFurnace, ComesToAnEnd) {
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled})
    for (const float reflectance : {0.95f, 0.98f, 0.99f}) {
      FurnaceParameters furnace;
      furnace.reflectance = reflectance;
      const SolverState state =
          testing::solve(furnace_scene(furnace), testing::options_of(links, 0.2f));
      EXPECT_LT(state.link_total(), 1'000'000u);
      // What refined links miss of each bounce, such walls multiply.
      const float share = mean_irradiance(state) * (1.f - reflectance) / kPi;
      EXPECT_LT(share, 1.05f) << reflectance;
      EXPECT_GT(share, links == LinkMaker::sampled ? 0.95f : 0.f) << reflectance;
    }
}

}  // namespace
}  // namespace halflight
