#include <gtest/gtest.h>

#include "gltf_check.h"
#include "halflight/io/load_scene.h"
#include "halflight/io/write_gltf.h"
#include "halflight/scene/geometry.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

// Total area and power pi A L of emitters, which no placement error leaves alone.
struct Totals {
  double area = 0.0;
  Rgb power{0.f};
};

Totals totals(const Scene& s, const Geometry& g) {
  Totals t;
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const float area = 0.5f * glm::length(g.scaled_normal(TriangleId(i)));
    t.area += static_cast<double>(area);
    t.power += kPi * area * emission_at(s, g, TriangleId(i), Vec2(1.f / 3.f));
  }
  return t;
}

class RoundTrip : public testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, AWrittenSceneReadsBackAsItWas) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const auto before = load_scene(shared_scenes() / GetParam());
  ASSERT_TRUE(before) << before.error().line();
  const auto file = test::temporary_file("round-trip.glb");
  ASSERT_TRUE(write_scene_glb(file, *before));
  const auto after = load_scene(file);
  ASSERT_TRUE(after) << after.error().line();
  std::filesystem::remove(file);

  const Geometry g = flatten(*before), h = flatten(*after);
  EXPECT_EQ(h.triangles.size(), g.triangles.size());
  EXPECT_EQ(h.cameras.size(), g.cameras.size());
  EXPECT_EQ(h.lights.size(), g.lights.size());
  EXPECT_LT(glm::distance(h.bounds.lower, g.bounds.lower), 1e-4f * g.bounds.diagonal());
  EXPECT_LT(glm::distance(h.bounds.upper, g.bounds.upper), 1e-4f * g.bounds.diagonal());
  const Totals was = totals(*before, g), is = totals(*after, h);
  EXPECT_NEAR(is.area, was.area, 1e-4 * was.area);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(is.power[c], was.power[c], 1e-4f * was.power[c]);
  for (std::size_t i = 0; i < std::min(before->nodes.size(), after->nodes.size()); ++i)
    EXPECT_EQ(after->nodes[NodeId(i)].name, before->nodes[NodeId(i)].name);
}

INSTANTIATE_TEST_SUITE_P(SharedScenes, RoundTrip,
                         testing::Values("cornell-box/CornellBox-Original.obj",
                                         "staircase2/staircase2.obj",
                                         "furnished-living-room/furnished-living-room.glb",
                                         "office-block/office-block.glb"));

}  // namespace
}  // namespace halflight
