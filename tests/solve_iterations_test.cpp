// Progressive multi-gridding (paper section 6.2): iterations of limited size, each a valid result,
// that end where one large step does; and the error that is told of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "halflight/rays/path_tracer.h"
#include "halflight/scene/procedural/doorway.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/solve/sweep.h"
#include "sanitized.h"
#include "solved_scene.h"

namespace halflight {
namespace {

constexpr std::size_t kMost = 500;  // links of an iteration

SolverState solve_by_iterations(const SolveOptions& options, const IterationBudget& budget,
                                const std::function<void(const SolverState&)>& look) {
  SolverState state = make_state(make_world(doorway_scene()), options);
  while (!state.done()) {
    advance(state, Progress(), budget);
    look(state);
  }
  return state;
}

float relative_rms(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    squares += static_cast<double>((a[i] - b[i]) * (a[i] - b[i]));
  return static_cast<float>(std::sqrt(squares / static_cast<double>(a.size()))) / testing::mean(b);
}

TEST(ErrorHistogram, ThresholdLeavesAboutSoManyAbove) {
  ErrorHistogram histogram;
  std::vector<float> errors;
  for (int i = 0; i < 1000; ++i) {
    errors.push_back(1.f + 1e-4f * static_cast<float>(i * i));
    histogram.add(errors.back());
  }
  float last = kInfinity;
  for (const std::size_t k : {20u, 50u, 200u, 700u, 2000u}) {
    const float threshold = histogram.threshold_for(k);
    const auto above =
        std::count_if(errors.begin(), errors.end(), [&](float e) { return e > threshold; });
    EXPECT_GE(static_cast<std::size_t>(above), std::min<std::size_t>(k, 999) / 2) << k;
    EXPECT_LE(static_cast<std::size_t>(above), k + 60) << k;  // a bin more at most
    EXPECT_LE(threshold, last);
    last = threshold;
  }
  EXPECT_FLOAT_EQ(last, 1.f);  // room for all
}

TEST(ErrorHistogram, CrowdedHighestBinStillGivesWork) {
  ErrorHistogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(8.f);
  EXPECT_LT(histogram.threshold_for(10), 8.f);
}

TEST(ErrorHistogram, RoomForOneStillGivesWork) {
  ErrorHistogram histogram;
  for (int i = 0; i < 3; ++i) histogram.add(8.f);
  EXPECT_LT(histogram.threshold_for(1), 8.f);
}

TEST(CostModel, LearnsWhatItIsTold) {
  CostModel costs;
  for (int i = 0; i < 8; ++i) {
    costs.learn(Stage::refine, 1000, 0.5, 20'000, 25'000);
    costs.learn_sweeps(100'000, 2, 0.02);
  }
  const double predicted = costs.predict(Stage::refine, 2000, 100'000, 2);
  EXPECT_NEAR(predicted, 2000 * 0.5e-3 + 2 * 1e-7 * (100'000 + 2000 * 5), 1e-6);
  const std::size_t k = costs.affordable(Stage::refine, predicted, 100'000, 2);
  EXPECT_NEAR(static_cast<double>(k), 2000.0, 1.0);
  EXPECT_EQ(costs.affordable(Stage::refine, 0.01, 1'000'000'000, 2), 0u);
}

class Iterations : public ::testing::TestWithParam<LinkMaker> {};

TEST_P(Iterations, RefineAtMostSoManyLinksAndStayValid) {
  std::size_t count = 0;
  float threshold = kInfinity;
  solve_by_iterations(testing::options_of(GetParam(), 0.1f), {.links = kMost},
                      [&](const SolverState& state) {
                        ++count;
                        const IterationRecord& last = state.history.back();
                        EXPECT_LE(last.refined, kMost);
                        for (const Rgb& e : state.irradiance.raw())
                          ASSERT_TRUE(average(e) >= 0.f && std::isfinite(average(e)));
                        if (last.stage == Stage::refine && count > 1) {
                          // Coarse to fine, but for the mean that each level learns.
                          EXPECT_LT(last.irradiance_threshold, 1.3f * threshold);
                          threshold = last.irradiance_threshold;
                        }
                      });
  EXPECT_GT(count, 10u);
}

TEST(Iterations, SplitNoCellFinerThanTheirLevelNeeds) {
  SolverState state = make_state(make_world(doorway_scene()),
                                 testing::options_of(LinkMaker::refined, 0.05f, 0.02f));
  float last = kInfinity;
  for (const float scale : {4.f, 2.f, 1.f}) {
    advance(state, Progress());
    float smallest = kInfinity;
    for (std::size_t i = 0; i < state.tree.size(); ++i)
      if (const ElementId e(i); state.tree[e].is_leaf_cell())
        smallest = std::min(smallest, state.tree.cell_size(e));
    EXPECT_GT(smallest, 0.99f * scale * 0.5f * 0.05f);
    EXPECT_LT(smallest, last);
    last = smallest;
  }
}

TEST_P(Iterations, EndWhereOneStepDoes) {
  const SolveOptions options = testing::options_of(GetParam(), 0.1f, 0.05f);
  const SolverState at_once = testing::solve(doorway_scene(), options);
  const SolverState bit_by_bit =
      solve_by_iterations(options, {.links = 10 * kMost}, [](const SolverState&) {});
  const auto points = scatter_points(at_once, 400);
  // Weights of refined links are estimates with an error of their own, and other links come of
  // another order.
  EXPECT_LT(relative_rms(testing::read_irradiance(bit_by_bit, points, kMeshReading),
                         testing::read_irradiance(at_once, points, kMeshReading)),
            GetParam() == LinkMaker::sampled ? 0.02f : 0.12f);
}

TEST_P(Iterations, OfTheSameSizeGiveTheSameBits) {
  const SolveOptions options = testing::options_of(GetParam(), 0.2f, 0.2f);
  const auto run = [&] {
    return solve_by_iterations(options, {.links = kMost}, [](const SolverState&) {});
  };
  const SolverState a = run(), b = run();
  ASSERT_EQ(a.tree.size(), b.tree.size());
  EXPECT_EQ(a.radiosity.raw(), b.radiosity.raw());
}

INSTANTIATE_TEST_SUITE_P(Links, Iterations,
                         ::testing::Values(LinkMaker::refined, LinkMaker::sampled),
                         [](const auto& test) {
                           return test.param == LinkMaker::refined ? "Refined" : "Sampled";
                         });

TEST(Iterations, KeepToTheirTime) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers are slow at random";
  LooseTrianglesParameters p;
  p.count = 4000;
  SolverState state = make_state(make_world(loose_triangles_scene(p)), SolveOptions{});
  constexpr double kSeconds = 0.05;
  std::vector<double> seconds;
  while (!state.done() && seconds.size() < 40) {
    advance(state, Progress(), {.seconds = kSeconds});
    seconds.push_back(state.history.back().seconds());
  }
  // Half of them on a machine that may do other things as well.
  std::sort(seconds.begin(), seconds.end());
  EXPECT_LT(seconds[seconds.size() / 2], 2.0 * kSeconds);
}

// Area-weighted error of what sensors read, against many paths.
float error_by_paths(const SolverState& state) {
  const PathTracer tracer(*state.world);
  const auto points = scatter_points(state, 300);
  const auto read = testing::read_irradiance(state, points, sensor_reading(state));
  std::vector<float> truth;
  for (const ReadingPoint& p : points)
    truth.push_back(average(tracer.estimate_irradiance(p.position, p.normal, 1024, 5).mean));
  return relative_rms(read, truth);
}

TEST(EstimatedError, AgreesWithTheErrorWithinAFactorOfTwo) {
  // Without its light the solution is wrong by a known amount: half of the irradiance is missing.
  SolverState state =
      testing::solve(doorway_scene(), testing::options_of(LinkMaker::sampled, 0.1f));
  const ErrorProbes probes(state);
  EXPECT_LT(probes.measure(state)->relative_rms, 0.05f);
  for (Rgb& e : state.irradiance.raw()) e *= 2.f;
  const float error = error_by_paths(state), estimated = probes.measure(state)->relative_rms;
  EXPECT_GT(error, 0.1f);
  EXPECT_GT(estimated, error / 2);
  EXPECT_LT(estimated, error * 2);
}

TEST(EstimatedError, FallsWhenASmallerOneIsAimedAt) {
  SolverState state =
      testing::solve(doorway_scene(), testing::options_of(LinkMaker::sampled, 0.4f, 2.f));
  const std::size_t coarse = state.link_total();
  const float before = error_by_paths(state);
  aim_finer(state, 40.f);
  EXPECT_FALSE(state.done());
  while (!state.done()) advance(state, Progress(), {.links = 20'000});
  EXPECT_GT(state.link_total(), coarse);
  EXPECT_LT(error_by_paths(state), before);
  const EnergyBalance balance = energy_balance(state);
  EXPECT_NEAR(average(balance.absorbed) / average(balance.emitted), 1.f, 0.02f);
}

// Clutter of more receivers than a coarse solution has; of few elements or many.
std::shared_ptr<const World> cluttered_room(int triangles) {
  const float size = std::sqrt(50.f / static_cast<float>(triangles));
  return make_world(loose_triangles_scene({.count = triangles, .size = size}));
}
constexpr float kFeatureOfClutter = 0.1f;
constexpr int kFew = 20'000, kMany = 120'000;

TEST(CoarseRound, FirstIterationLightsAllHoweverShort) {
  SolverState state =
      make_state(cluttered_room(kMany), {.feature_size = kFeatureOfClutter}, Beginning::coarse);
  advance(state, Progress(), {.links = 1});
  EXPECT_TRUE(state.schedule.receivers.empty());
  EXPECT_GT(state.schedule.receiver_scale, 1.f);
  EXPECT_LT(state.history.front().refined, 8'000u);
  const float first = mean_irradiance(state);
  while (!state.done()) advance(state, Progress());
  EXPECT_NEAR(first, mean_irradiance(state), 0.2f * mean_irradiance(state));
}

class CoarseBeginning : public ::testing::TestWithParam<int> {};

TEST_P(CoarseBeginning, EndsWhereADirectSolveDoes) {
  const auto world = cluttered_room(GetParam());
  const SolveOptions options{.feature_size = kFeatureOfClutter};
  const auto solve = [&](Beginning beginning) {
    SolverState state = make_state(world, options, beginning);
    while (!state.done()) advance(state, Progress());
    return state;
  };
  const SolverState coarsely = solve(Beginning::coarse), direct = solve(Beginning::as_asked);
  EXPECT_TRUE(coarsely.fine_parts_made);
  EXPECT_EQ(coarsely.schedule.receiver_scale, 1.f);
  // Each is within a percent of a solution for an error of 1 %, on either side.
  EXPECT_NEAR(mean_irradiance(coarsely), mean_irradiance(direct), 0.02f * mean_irradiance(direct));
  const auto points = scatter_points(direct, 400);
  EXPECT_LT(relative_rms(testing::read_irradiance(coarsely, points, kMeshReading),
                         testing::read_irradiance(direct, points, kMeshReading)),
            0.07f);  // two solutions of 5 % each, by paths
}
INSTANTIATE_TEST_SUITE_P(Sizes, CoarseBeginning, ::testing::Values(kFew, kMany));

// What is found anew for the receivers of an iteration is what is found anew for all.
TEST(CoarseRound, RowLimitsOfSomeAreThoseOfAll) {
  SolverState state =
      make_state(cluttered_room(kMany), {.feature_size = kFeatureOfClutter}, Beginning::coarse);
  while (state.schedule.round < 2 || state.schedule.receivers.empty())
    advance(state, Progress(), {.links = 20'000});
  advance(state, Progress(), {.links = 20'000});
  SolverState anew = state;
  anew.row_limits.clear();
  sweep(anew, 1);
  EXPECT_EQ(anew.row_limits.raw(), state.row_limits.raw());
}

}  // namespace
}  // namespace halflight
