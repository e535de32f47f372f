// The same bits of light for any number of threads, and for every run.
#include <gtest/gtest.h>

#include <cstring>

#include "halflight/base/parallel.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "solved_scene.h"

namespace halflight {
namespace {

struct Bits {
  std::vector<Rgb> radiosity, irradiance, readings;
  std::size_t links = 0;
};

Bits solve_crowd(LinkMaker links, int threads) {
  set_thread_count(threads);
  LooseTrianglesParameters p;
  p.count = 400;
  const SolverState state =
      testing::solve(loose_triangles_scene(p), testing::options_of(links, 0.3f, 0.2f));
  Bits bits{state.radiosity.raw(), state.irradiance.raw(), {}, state.link_total()};
  const SolutionReader reader(state, kMeshReading);
  for (const Reading& r : reader(scatter_points(state, 50)))
    bits.readings.push_back(r.irradiance());
  set_thread_count(0);
  return bits;
}

bool same(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

class Determinism : public ::testing::TestWithParam<LinkMaker> {};

TEST_P(Determinism, RadiosityIsTheSameBitForBit) {
  const Bits once = solve_crowd(GetParam(), 1);
  EXPECT_GT(once.links, 1000u);
  for (const int threads : {1, 2, 3}) {
    const Bits again = solve_crowd(GetParam(), threads);
    EXPECT_EQ(again.links, once.links) << threads << " threads";
    EXPECT_TRUE(same(again.radiosity, once.radiosity)) << threads << " threads";
    EXPECT_TRUE(same(again.irradiance, once.irradiance)) << threads << " threads";
    EXPECT_TRUE(same(again.readings, once.readings)) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Links, Determinism,
                         ::testing::Values(LinkMaker::refined, LinkMaker::sampled),
                         [](const auto& test) {
                           return test.param == LinkMaker::refined ? "Refined" : "Sampled";
                         });

}  // namespace
}  // namespace halflight
