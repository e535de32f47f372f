// Geometry that no light can be computed on is left out, and what is left is lit.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "halflight/io/load_scene.h"
#include "halflight/output/estimated_error.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/path_tracer.h"
#include "quad_scene.h"
#include "solved_scene.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

// Scales that overflow give places that are no numbers at all, and single precision has no room for
// the squares of lengths beyond 1e19 m: such triangles are left out, and the rest is lit.
TEST(HostileGeometry, PlacesOutOfReachAreLeftOut) {
  for (const double scale : {1e10, 1e25, 1e200}) {
    const TemporaryFolder folder;
    GltfBuilder gltf;
    gltf.add_triangle();
    gltf.add("nodes", {{"mesh", 0}, {"scale", {scale, scale, scale}}});
    gltf.add_root({{"children", {1}}, {"scale", {scale, scale, scale}}});
    auto scene = load_scene(folder.write("far.glb", gltf.glb()));
    if (!scene) continue;
    scene->sky = Rgb(1.f);
    const Geometry g = flatten(*scene);
    EXPECT_EQ(g.triangles.size(), 1u);
    EXPECT_EQ(g.degenerate_triangles, 1u);
    for (const Vec3& p : g.positions.raw()) EXPECT_TRUE(is_finite(p));
    const SolverState state =
        testing::solve(std::move(*scene), testing::options_of(LinkMaker::sampled, 0.1f));
    EXPECT_TRUE(std::isfinite(mean_irradiance(state)));
    EXPECT_GT(mean_irradiance(state), 0.f);
  }
}

// A room of 3 m with a lamp of this radiance.
testing::QuadScene lit_room(float radiance) {
  testing::QuadScene room;
  room.box({0, 0, 0}, {3, 2, 3}, room.material(0.5f), true);
  room.quad({1, 1.9f, 1}, {1, 0, 0}, {0, 0, 1}, room.material(0.f, radiance));
  return room;
}

// What is flushed to 0 in squares has no normal.
TEST(HostileGeometry, SliversWithoutANormalAreLeftOut) {
  testing::QuadScene room = lit_room(5.f);
  room.triangle({0, 0, 0.5f}, {1.5f, 0, 0.5f}, {0.5f, 1e-20f, 0.5f}, room.material(0.5f));
  EXPECT_EQ(flatten(room.scene).degenerate_triangles, 1u);
  const SolverState state =
      testing::solve(room.scene, testing::options_of(LinkMaker::sampled, 0.3f));
  EXPECT_TRUE(std::isfinite(mean_irradiance(state)));
}

// Light that squares take out of single precision, and lamps too weak to be chosen by their power.
TEST(HostileGeometry, FaintLightIsFiniteAndItsErrorANumber) {
  const SolverState faint =
      testing::solve(lit_room(1e-26f).scene, testing::options_of(LinkMaker::sampled, 0.3f));
  EXPECT_GT(mean_irradiance(faint), 0.f);
  const EstimatedError error = ErrorProbes(faint).measure(faint).value();
  EXPECT_TRUE(std::isfinite(error.relative_rms));
  EXPECT_LT(error.relative_rms, 0.2f);

  testing::QuadScene room = lit_room(0.f);
  const MaterialId spark = room.material(0.f, 1e-24f);
  for (int i = 0; i < 20; ++i)
    room.quad({0.1f * static_cast<float>(i), 1, 1}, {1e-7f, 0, 0}, {0, 0, 1e-7f}, spark);
  const SolverState state =
      testing::solve(room.scene, testing::options_of(LinkMaker::sampled, 0.3f));
  for (std::size_t i = 0; i < state.tree.size(); ++i)
    EXPECT_TRUE(is_finite(state.irradiance[ElementId(i)]));
}

// An ordinary bulb of thousands of facets in a black hall sends what a sphere does.
TEST(HostileGeometry, SmallBulbsSendWhatTheyHave) {
  testing::QuadScene hall;
  hall.box({0, 0, 0}, {20, 5, 20}, hall.material(0.f), true);
  const float radius = 0.04f;
  hall.ball({10, 2.5f, 10}, radius, hall.material(0.f, 1000.f), false, 40);
  const SolverState state =
      testing::solve(hall.scene, testing::options_of(LinkMaker::sampled, 0.5f));
  std::vector<ReadingPoint> floor;
  float expected = 0.f;
  for (int i = 0; i < 100; ++i) {
    const Vec3 x(0.7f + 0.3f * static_cast<float>(i % 10), 0,
                 1.f + 1.9f * static_cast<float>(i / 10));
    const Vec3 to = Vec3(10, 2.5f, 10) - x;
    const float squared = glm::dot(to, to);
    expected += kPi * 10.f * radius * radius * to.y / (squared * std::sqrt(squared));
    floor.push_back({x, {0, 1, 0}, {}});
  }
  EXPECT_NEAR(testing::mean(testing::read_irradiance(state, floor)) / expected, 1.f, 0.04f);
  const EnergyBalance balance = energy_balance(state);
  EXPECT_NEAR(average(balance.absorbed) / average(balance.emitted), 1.f, 0.05f);
}

TEST(HostileGeometry, PointLightsInTheCeilingShine) {
  testing::QuadScene room;
  room.box({0, 0, 0}, {3, 2, 3}, room.material(0.f), true);
  Light bulb;
  bulb.intensity = Rgb(10.f);
  Node node;
  node.light = room.scene.lights.push_back(bulb);
  node.local[3] = glm::dvec4(1.5, 2.0, 1.5, 1.0);
  room.scene.nodes.push_back(node);
  const SolverState state =
      testing::solve(room.scene, testing::options_of(LinkMaker::sampled, 0.3f));
  EXPECT_NEAR(testing::read_irradiance(state, {{{1.5f, 0, 1.5f}, {0, 1, 0}, {}}}).front(), 2.5f,
              0.01f);
  const PathTracer tracer(*state.world);
  EXPECT_NEAR(average(tracer.estimate_irradiance({1.5f, 0, 1.5f}, {0, 1, 0}, 64, 1).mean), 2.5f,
              0.01f);
}

// Halves of edges that differ from their ends by nothing are no progress.
TEST(HostileGeometry, LitMeshesFarFromTheOriginEnd) {
  Scene scene = lit_room(5.f).scene;
  scene.to_world[3] = glm::dvec4(1e5, 1e5, 1e5, 1.0);
  const SolverState state =
      testing::solve(std::move(scene), testing::options_of(LinkMaker::sampled, 0.3f));
  EXPECT_GE(finest_mesh_edge(state), 2.f * state.world->rays.lift_distance());
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  options.finest = finest_mesh_edge(state);
  const SolutionReader reader(state, kMeshReading);
  const LitMesh mesh = build_lit_mesh(
      state.world->scene, state.world->geometry,
      [&](std::span<const ReadingPoint> points) { return reader(points); }, options);
  std::size_t vertices = 0;
  for (const LitPrimitive& p : mesh.primitives) vertices += p.positions.size();
  EXPECT_LT(vertices, 10'000u);
}

TEST(HostileGeometry, MeasuringTheErrorEndsWhenItIsCancelled) {
  const SolverState state =
      testing::solve(lit_room(5.f).scene, testing::options_of(LinkMaker::sampled, 0.3f, 0.001f));
  Progress cancelled;
  cancelled.cancel();
  const std::uint64_t before = state.world->rays.ray_total();
  ErrorProbes(state, cancelled).measure(state, cancelled);
  EXPECT_LT(state.world->rays.ray_total() - before, 10'000u);
}

// Sheets with a hole in all but one texel: few samples of such a cell meet anything of it, and
// where none did, rays that hit it all the same bring no light instead of an infinite share of
// none.
TEST(HostileGeometry, CellsThatAreNearlyAllHoleGiveFiniteLight) {
  testing::QuadScene room;
  room.box({0, 0, 0}, {3, 2, 3}, room.material(0.6f), true);
  room.quad({1, 1.9f, 1}, {1, 0, 0}, {0, 0, 1}, room.material(0.f, 5.f));
  for (std::size_t i = 0; i < 8; ++i) {
    Texture dot;
    dot.width = dot.height = 8;
    dot.texels.assign(64, {255, 255, 255, 0});
    dot.texels[9 * i % 64] = {255, 255, 255, 255};
    const MaterialId sheet = room.material(0.5f);
    room.scene.materials[sheet].alpha_mode = AlphaMode::blend;
    room.scene.materials[sheet].alpha_texture.texture = room.scene.textures.push_back(dot);
    room.quad({0.2f, 0.2f + 0.2f * static_cast<float>(i), 0.2f}, {0, 0, 2.6f}, {2.6f, 0, 0}, sheet);
  }
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled}) {
    const SolverState state = testing::solve(room.scene, testing::options_of(links, 2.f));
    bool nothing = false;
    for (std::size_t i = 0; i < state.tree.size(); ++i) {
      const ElementId e(i);
      nothing = nothing || state.opacity[e] == 0.f;
      EXPECT_TRUE(is_finite(state.irradiance[e]));
      EXPECT_TRUE(is_finite(state.radiosity[e]));
      for (const LinkTable* table : {&state.links, &state.sampled_links})
        for (const Link& l : table->of(e)) EXPECT_TRUE(std::isfinite(l.weight));
    }
    EXPECT_TRUE(nothing) << "no cell was missed by all of its samples: the test looks at nothing";
  }
}

}  // namespace
}  // namespace halflight
