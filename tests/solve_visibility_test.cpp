// Feature size and visibility through the whole solver: what is exact, what is saved, what is lost.
#include <gtest/gtest.h>

#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"
#include "halflight/transport/sampled_links.h"
#include "solved_scene.h"

namespace halflight {
namespace {

SolveOptions options_of(VisibilityMode mode, float feature_size) {
  SolveOptions options;
  options.visibility = mode;
  options.visibility_pilot = false;
  options.feature_size = feature_size;
  return options;
}

class PlantsUnderMedia : public ::testing::Test {
 protected:
  static constexpr float kSize = 0.3f;
  std::shared_ptr<const World> world = make_world(plants_scene({.count = 8000}));
};

TEST_F(PlantsUnderMedia, FeatureSizeZeroIsExactBitForBit) {
  // An error this large keeps the meshes small; the gate is off.
  auto multires = options_of(VisibilityMode::multires, 0.f);
  auto exact = options_of(VisibilityMode::exact, 0.f);
  multires.error = exact.error = 0.4f;
  const SolverState a = testing::solve(world, multires), b = testing::solve(world, exact);
  EXPECT_EQ(a.visibility->mode(), VisibilityMode::exact);
  EXPECT_EQ(a.irradiance.raw(), b.irradiance.raw());
}

TEST_F(PlantsUnderMedia, LoseLittleLightAgainstExactRays) {
  const float exact =
      mean_irradiance(testing::solve(world, options_of(VisibilityMode::exact, kSize)));
  const SolverState multires = testing::solve(world, options_of(VisibilityMode::multires, kSize));
  EXPECT_GT(multires.visibility->ray_total(), 0u);
  EXPECT_NEAR(mean_irradiance(multires) / exact, 1.f, 0.03f);
  const SolverState average = testing::solve(world, options_of(VisibilityMode::average, kSize));
  EXPECT_NEAR(mean_irradiance(average) / exact, 1.f, 0.06f);
}

TEST_F(PlantsUnderMedia, SensorsOnTheFloorSeeTheSameLightOnTheMean) {
  const SolverState exact = testing::solve(world, options_of(VisibilityMode::exact, kSize));
  const SolverState multires = testing::solve(world, options_of(VisibilityMode::multires, kSize));
  std::vector<ReadingPoint> floor(200);
  const Bounds3f& room = world->geometry.bounds;
  for (std::uint32_t i = 0; i < floor.size(); ++i) {
    const Vec2 u = r2_sequence(i);
    floor[i].position = room.lower + Vec3(u.x, 0.f, u.y) * room.extent();
    floor[i].position.y = room.lower.y;
    floor[i].normal = Vec3(0.f, 1.f, 0.f);
  }
  const float a = testing::mean(testing::read_irradiance(exact, floor, kMeshReading));
  const float b = testing::mean(testing::read_irradiance(multires, floor, kMeshReading));
  EXPECT_NEAR(b / a, 1.f, 0.04f);
}

TEST(VisibilityPilot, LeavesAnOfficeToExactRays) {
  SolveOptions options;
  options.feature_size = 0.1f;
  const SolverState state = make_state(make_world(office_scene({.count = 300})), options);
  EXPECT_EQ(state.visibility->mode(), VisibilityMode::exact);
}

TEST(FeatureGate, ElementsLinksAndRaysFallAsTheFeatureSizeGrows) {
  const auto world = make_world(office_scene({.count = 300}));
  std::size_t elements = SIZE_MAX, links = SIZE_MAX;
  std::uint64_t rays = UINT64_MAX;
  for (const float s : {0.15f, 0.5f, 1.5f}) {
    const std::uint64_t before = world->rays.ray_total();
    const SolverState state = testing::solve(world, options_of(VisibilityMode::exact, s));
    const std::uint64_t now = world->rays.ray_total() - before;
    EXPECT_LT(state.tree.size(), elements) << s;
    EXPECT_LT(state.link_total(), links) << s;
    EXPECT_LT(now, rays) << s;
    elements = state.tree.size();
    links = state.link_total();
    rays = now;
  }
}

// Light on a cluster as one against that of its cells one by one.
TEST(ClusterLight, IsThatOfItsCellsOnTheMean) {
  const auto world = make_world(plants_scene({.count = 8000}));
  const SolverState state = make_state(world, options_of(VisibilityMode::exact, 0.3f));
  const EmitterTree emitters(*state.visibility, find_emitters(*world));
  SampledLinkOptions options;
  double of_clusters = 0.0, of_cells = 0.0;
  int clusters = 0;
  for (const ElementId r :
       choose_receivers(state.tree, {state.tree.root()}, state.receiver_sizes)) {
    if (!state.tree[r].is_cluster()) continue;
    ++clusters;
    const DirectionalIrradiance light = directional_irradiance(
        sample_direct_light(state.tree, *state.visibility, emitters, r, options).of_emitters);
    std::vector<ElementId> open{r};
    while (!open.empty()) {
      const ElementId e = open.back();
      open.pop_back();
      for (const ElementId child : state.tree[e].children()) open.push_back(child);
      if (state.tree[e].is_cluster()) continue;
      const Vec3 n = state.tree.normal(e);
      const auto area = static_cast<double>(state.tree[e].area);
      of_clusters += area * static_cast<double>(average(light.irradiance(n)));
      const Vec3 x = state.tree.sample(e, r2_sequence(e.value)).position;
      of_cells += area * static_cast<double>(
                             average(emitters.irradiance(x, n, {}, random_shift(hash(e.value)))));
    }
  }
  EXPECT_GT(clusters, 20);
  EXPECT_NEAR(of_clusters / of_cells, 1.0, 0.03);
}

}  // namespace
}  // namespace halflight
