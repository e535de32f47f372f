#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "halflight/rays/light_tree.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

Vec3 random_point(std::uint64_t seed) {
  return {to_unit_float(hash(seed, 1)), to_unit_float(hash(seed, 2)), to_unit_float(hash(seed, 3))};
}

std::vector<LightBounds> random_lights(std::size_t n) {
  std::vector<LightBounds> lights(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 corner = 10.f * random_point(i);
    lights[i].bounds.extend(corner);
    lights[i].bounds.extend(corner + 0.3f * random_point(i + 1000));
    lights[i].axis = glm::normalize(random_point(i + 2000) - 0.5f);
    lights[i].cos_cone = i % 5 == 0 ? 0.6f : 1.f;
    lights[i].two_sided = i % 3 == 0;
    lights[i].intensity = 0.1f + to_unit_float(hash(i, 9));
  }
  return lights;
}

TEST(LightTree, ProbabilitiesOfAllLightsAddUpToOneOrLess) {
  const auto lights = random_lights(257);
  const LightTree tree(lights);
  double best = 0.0;
  for (int k = 0; k < 20; ++k) {
    const Vec3 p = 12.f * random_point(k + 5000) - 1.f;
    const Vec3 n = glm::normalize(random_point(k + 6000) - 0.5f);
    double sum = 0.0;
    for (std::size_t i = 0; i < lights.size(); ++i) sum += tree.probability(EmitterId(i), p, n);
    // A branch may turn out dark below a node that seemed to shine: that share draws no light.
    EXPECT_LE(sum, 1.0 + 1e-5);
    best = std::max(best, sum);
  }
  EXPECT_GT(best, 0.9);
}

TEST(LightTree, DrawsEachLightAsOftenAsItsProbabilitySays) {
  const auto lights = random_lights(40);
  const LightTree tree(lights);
  const Vec3 p(5.f, 0.f, 5.f), n(0.f, 1.f, 0.f);
  constexpr int kDraws = 200000;
  std::vector<int> count(lights.size());
  for (int i = 0; i < kDraws; ++i) {
    const auto choice = tree.choose(p, n, (static_cast<float>(i) + 0.5f) / kDraws);
    if (!choice) continue;
    EXPECT_FLOAT_EQ(choice->probability, tree.probability(choice->emitter, p, n));
    ++count[choice->emitter.value];
  }
  for (std::size_t i = 0; i < lights.size(); ++i)
    EXPECT_NEAR(count[i] / double(kDraws), tree.probability(EmitterId(i), p, n), 1e-3) << i;
}

TEST(LightTree, NoLightThatReachesAPointIsLeftOut) {
  const auto lights = random_lights(200);
  const LightTree tree(lights);
  for (int k = 0; k < 50; ++k) {
    const Vec3 p = 12.f * random_point(k + 7000) - 1.f;
    const Vec3 n = glm::normalize(random_point(k + 8000) - 0.5f);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const bool reaches = irradiance_estimate(lights[i], p, n) > 1e-6f;
      EXPECT_TRUE(!reaches || tree.probability(EmitterId(i), p, n) > 0.f) << i;
    }
  }
}

TEST(LightTree, PrefersTheLampOfTheOwnRoom) {
  // 1,000 equal lamps 4 m apart: the one 2 m above the point sends most of the light.
  std::vector<LightBounds> lights(1000);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].bounds.extend(Vec3(4.f * static_cast<float>(i), 2.f, 0.f));
    lights[i].axis = Vec3(0.f, -1.f, 0.f);
    lights[i].intensity = 1.f;
  }
  const LightTree tree(lights);
  EXPECT_GT(tree.probability(EmitterId(333u), Vec3(1332.f, 0.f, 0.f), Vec3(0.f, 1.f, 0.f)), 0.5f);
}

}  // namespace
}  // namespace halflight
