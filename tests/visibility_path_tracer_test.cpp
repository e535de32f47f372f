// Path tracing with shadows by multi-resolution visibility: how far from exact shadows.
#include <gtest/gtest.h>

#include "halflight/rays/path_tracer.h"
#include "halflight/rays/sampling.h"
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

// A shadow test of one's own changes how direct light is sampled, not what it is on the mean.
TEST_F(PathTracedPlants, FeatureSizeZeroIsUnbiased) {
  const float exact = floor_irradiance(PathTracer(*world));
  EXPECT_NEAR(with(VisibilityMode::multires, 0.f) / exact, 1.f, 0.01f);
}

}  // namespace
}  // namespace halflight
