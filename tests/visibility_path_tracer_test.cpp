// Path tracing with shadows by multi-resolution visibility: how far from exact shadows.
#include <gtest/gtest.h>

#include "halflight/rays/path_tracer.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/procedural/plants.h"
#include "halflight/visibility/multires_build.h"
#include "halflight/visibility/multires_paths.h"

namespace halflight {
namespace {

class PathTracedPlants : public ::testing::Test {
 protected:
  const std::shared_ptr<const World> world = make_world(plants_scene({.count = 16000}));
  const Surfaces surfaces = build_surfaces(world->geometry);

  // Mean over points of the floor.
  float floor_irradiance(const PathTracer& tracer) const {
    const Bounds3f& room = world->geometry.bounds;
    float sum = 0.f;
    constexpr std::uint32_t kPoints = 100;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Vec2 u = r2_sequence(i);
      const Vec3 p(room.lower.x + u.x * room.extent().x, room.lower.y,
                   room.lower.z + u.y * room.extent().z);
      sum += average(tracer.estimate_irradiance(p, {0.f, 1.f, 0.f}, 128, i).mean);
    }
    return sum / kPoints;
  }
  float with(VisibilityMode mode, float feature_size,
             BounceRays bounces = BounceRays::exact) const {
    const Visibility visibility(*world, surfaces, one_cluster(surfaces), mode);
    const MultiresPaths rays(visibility, feature_size, bounces);
    return floor_irradiance(PathTracer(*world, &rays));
  }
};

TEST_F(PathTracedPlants, ShadowsByClustersHaveLittleBias) {
  const float exact = floor_irradiance(PathTracer(*world));
  EXPECT_NEAR(with(VisibilityMode::multires, 0.2f) / exact, 1.f, 0.02f);
  EXPECT_NEAR(with(VisibilityMode::average, 0.2f) / exact, 1.f, 0.03f);
}

// A path that is absorbed in a cluster goes on from what is seen of it, so that the bright side of
// a plant stays bright. Absorbing paths that bring back a cluster's mean light lose 8 %.
TEST_F(PathTracedPlants, BouncesOffClustersAddLittleBias) {
  const float exact = floor_irradiance(PathTracer(*world));
  for (const auto mode : {VisibilityMode::multires, VisibilityMode::average}) {
    EXPECT_NEAR(with(mode, 0.05f, BounceRays::clusters) / exact, 1.f, 0.02f);
    EXPECT_NEAR(with(mode, 0.2f, BounceRays::clusters) / exact, 1.f, 0.03f);
  }
}

// The sampler's points against all that parallel rays through the cluster's box meet first.
TEST(ClusterSampler, PointsAreThoseSeenByParallelRays) {
  const auto world = make_world(loose_triangles_scene({4096, 0.1f, 3}));
  const Surfaces surfaces = build_surfaces(world->geometry);
  const MultiresTree tree(world->scene, world->geometry, surfaces, one_cluster(surfaces));
  const ClusterSampler sampler(*world, tree);
  const Geometry& g = world->geometry;
  int tried = 0;
  for (std::uint32_t slot = 0; slot < tree.arrays().contents.size() && tried < 40; ++slot) {
    if (!tree.arrays().has(slot)) continue;
    const auto& below = tree.arrays().contents[slot];
    if (below.last_block - below.first_block < 3) continue;
    const Bounds3f box = tree.arrays().box_of(slot);
    if (box.longest_side() > 0.25f * g.bounds.longest_side()) continue;
    ++tried;
    const Vec3 d = uniform_sphere({to_unit_float(hash(slot, 1)), to_unit_float(hash(slot, 2))});
    const Frame frame = Frame::from_normal(d);
    const float size = box.diagonal();
    // Along an axis of their own, so that a shift to the wrong side would show.
    const Vec3 axis = frame.tangent;
    constexpr std::uint32_t kPoints = 4000;
    double by_rays = 0.0, by_sampler = 0.0, squares = 0.0, front_rays = 0.0, front_sampler = 0.0;
    int met = 0, drawn = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Vec2 at = r2_sequence(i) - 0.5f;
      const Vec3 from =
          box.center() + size * (at.x * frame.tangent + at.y * frame.bitangent) - size * d;
      if (const auto hit = tree.nearest_below(slot, {from, d, 2.f * size}, i)) {
        const float along = glm::dot(hit_position(g, *hit) - box.center(), axis) / size;
        by_rays += static_cast<double>(along);
        front_rays += hit->front ? 1.0 : 0.0;
        ++met;
      }
      if (const auto hit = sampler.visible_point(slot, d, i)) {
        const float along = glm::dot(hit_position(g, *hit) - box.center(), axis) / size;
        by_sampler += static_cast<double>(along);
        squares += static_cast<double>(along * along);
        front_sampler += hit->front ? 1.0 : 0.0;
        ++drawn;
      }
    }
    if (met < 400) continue;
    ASSERT_EQ(drawn, static_cast<int>(kPoints));
    const double spread = std::sqrt(squares / drawn);
    EXPECT_NEAR(by_sampler / drawn, by_rays / met, 5.0 * spread / std::sqrt(met)) << slot;
    EXPECT_NEAR(front_sampler / drawn, front_rays / met, 2.5 / std::sqrt(met)) << slot;
  }
  EXPECT_GE(tried, 20);
}

// A shadow test of one's own changes how direct light is sampled, not what it is on the mean.
TEST_F(PathTracedPlants, FeatureSizeZeroIsUnbiased) {
  const float exact = floor_irradiance(PathTracer(*world));
  EXPECT_NEAR(with(VisibilityMode::multires, 0.f) / exact, 1.f, 0.01f);
}

}  // namespace
}  // namespace halflight
