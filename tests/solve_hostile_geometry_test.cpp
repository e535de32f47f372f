// Geometry that no light can be computed on is left out, and what is left is lit.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "halflight/io/load_scene.h"
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

}  // namespace
}  // namespace halflight
