// Geometry that no light can be computed on is left out, and what is left is lit.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "halflight/io/load_scene.h"
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
