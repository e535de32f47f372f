// Sweeps end at the light that the links ask for, mixed with earlier ones or not.
#include <gtest/gtest.h>

#include <algorithm>

#include "halflight/scene/procedural/cornell_box.h"
#include "halflight/scene/procedural/furnace.h"
#include "halflight/solve/sweep.h"
#include "solved_scene.h"

namespace halflight {
namespace {

constexpr double kVeryLittle = 1e-6;  // change of reflected power
constexpr int kEnough = 400;

// Nothing arrives yet, but for what comes from emitters directly.
SolverState in_the_dark(SolverState state) {
  std::fill(state.irradiance.raw().begin(), state.irradiance.raw().end(), Rgb(0.f));
  pull(state);
  return state;
}

// With a limit of memory, which leaves no room to remember earlier sweeps.
SolverState plain(SolverState state) {
  state.options.memory = std::size_t{1} << 40;
  return state;
}

SolverState white_box(Scene scene) {
  for (Material& m : scene.materials) m.reflectance = glm::max(m.reflectance, 0.95f);
  return in_the_dark(
      testing::solve(std::move(scene), testing::options_of(LinkMaker::sampled, 0.05f)));
}

TEST(Sweep, MixedWithEarlierOnesEndsAtTheSameLightSooner) {
  SolverState mixed = white_box(cornell_box_scene({})), alone = plain(mixed);
  const Sweeps few = sweep(mixed, kEnough, kVeryLittle), many = sweep(alone, kEnough, kVeryLittle);
  EXPECT_TRUE(few.converged);
  EXPECT_TRUE(many.converged);
  EXPECT_LT(2 * few.count, many.count);
  const auto power = [](const SolverState& state) {
    return average(energy_balance(state).absorbed);
  };
  EXPECT_NEAR(power(mixed) / power(alone), 1.f, 1e-4f);
  for (std::size_t i = 0; i < mixed.tree.size(); ++i)
    EXPECT_NEAR(average(mixed.irradiance[ElementId(i)]), average(alone.irradiance[ElementId(i)]),
                2e-3f * mean_irradiance(alone));
}

// Plain sweeps bring a hundredth of what is missing: ln 0.01 / ln 0.97 = 151 of them.
TEST(Sweep, LightsAWhiteFurnaceAtOnce) {
  FurnaceParameters furnace;
  furnace.reflectance = 0.97f;
  furnace.boxes = 27;
  SolverState state = in_the_dark(
      testing::solve(furnace_scene(furnace), testing::options_of(LinkMaker::sampled, 0.2f, 0.02f)));
  EXPECT_LT(sweep(state).count, 12);
  EXPECT_NEAR(mean_irradiance(state) * (1.f - furnace.reflectance) / kPi, 1.f, 0.02f);
}

}  // namespace
}  // namespace halflight
