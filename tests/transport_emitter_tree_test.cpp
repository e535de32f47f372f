// Direct light from the tree of emitters, against closed forms and sums over the emitters.
#include "halflight/transport/emitter_tree.h"

#include <gtest/gtest.h>

#include "clustered_world.h"
#include "halflight/rays/sampling.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::kDown;
using testing::kUp;
using testing::QuadScene;

struct Lamps {
  World world;
  Visibility visibility{world};
  EmitterTree emitters;

  explicit Lamps(const QuadScene& scene)
      : world(scene.scene), emitters(visibility, find_emitters(world)) {}
};

QuadScene panel_that_shines_down(float height, float side, float radiance) {
  QuadScene scene;
  scene.quad({0, height, 0}, {side, 0, 0}, {0, 0, side}, scene.material(0.f, radiance));
  return scene;
}

TEST(EmitterTree, UnderANearPanelGivesTheClosedForm) {
  const Lamps panel(panel_that_shines_down(0.5f, 2.f, 3.f));
  const float corner = 3.f * kPi * testing::corner_form_factor(2.f, 2.f, 0.5f);
  const float middle = 4.f * 3.f * kPi * testing::corner_form_factor(1.f, 1.f, 0.5f);
  EXPECT_NEAR(panel.emitters.irradiance({0, 0, 0}, kUp, {}).g, corner, 1e-3f * corner);
  EXPECT_NEAR(panel.emitters.irradiance({1, 0, 1}, kUp, {}).g, middle, 1e-3f * middle);
}

TEST(EmitterTree, FarFromATriangleGivesPowerCosinesAndDistance) {
  QuadScene scene;
  scene.triangle({0, 8, 0}, {0.3f, 8, 0}, {0, 8, 0.3f}, scene.material(0.f, 3.f));
  const Lamps triangle(scene);
  const Vec3 x(6.f, 0.f, 0.f), between = Vec3(0.1f, 8.f, 0.1f) - x;
  const float squared = glm::dot(between, between);
  const float expected = 3.f * 0.045f * 8.f * 8.f / (squared * squared);
  EXPECT_NEAR(triangle.emitters.irradiance(x, kUp, {}).g, expected, 2e-3f * expected);
  EXPECT_NEAR(triangle.emitters.unoccluded_irradiance(x, kUp), expected, 2e-3f * expected);
}

TEST(EmitterTree, NothingShinesBackwardsOrOnWhatIsTurnedAway) {
  const Lamps panel(panel_that_shines_down(0.5f, 2.f, 3.f));
  EXPECT_EQ(panel.emitters.irradiance({1, 1, 1}, kDown, {}).g, 0.f);
  EXPECT_EQ(panel.emitters.irradiance({1, 0, 1}, kDown, {}).g, 0.f);
}

// Small lamps all around, turned anywhere, and what they give a point without shadows.
class ManyLamps : public ::testing::Test {
 protected:
  static constexpr float kSide = 0.02f;
  struct Lamp {
    Vec3 middle, normal;
    float radiance;
  };
  std::vector<Lamp> lamps;
  QuadScene scene;

  void SetUp() override {
    testing::Dice dice(5);
    for (int i = 0; i < 300; ++i) {
      const Vec3 middle = dice.direction() * dice.between(2.f, 4.f);
      const Frame frame = dice.frame();
      const float radiance = dice.between(1.f, 20.f);
      const Vec3 u = kSide * frame.tangent, v = kSide * frame.bitangent;
      scene.quad(middle - 0.5f * (u + v), u, v, scene.material(0.f, radiance));
      lamps.push_back({middle, glm::normalize(glm::cross(u, v)), radiance});
    }
  }
  // Of a point at the origin.
  float sent(const Lamp& lamp) const {
    const float squared = glm::dot(lamp.middle, lamp.middle);
    const float cosine = std::max(0.f, -glm::dot(lamp.normal, lamp.middle)) / std::sqrt(squared);
    return lamp.radiance * kSide * kSide * cosine / squared;
  }
  float expected(const Vec3& n) const {
    float sum = 0.f;
    for (const Lamp& lamp : lamps)
      sum += sent(lamp) * std::max(0.f, glm::dot(n, glm::normalize(lamp.middle)));
    return sum;
  }
};

TEST_F(ManyLamps, OfWhichSomeAreChosenGiveTheSumOfAllOnTheMean) {
  const Lamps all(scene);
  constexpr std::uint32_t kShifts = 400;
  for (const Vec3& n : {kUp, glm::normalize(Vec3(1.f, -1.f, 2.f))}) {
    float mean = 0.f;
    for (std::uint32_t k = 0; k < kShifts; ++k)
      mean += all.emitters.irradiance(Vec3(0.f), n, {}, r2_sequence(k)).g / kShifts;
    EXPECT_NEAR(mean, expected(n), 0.03f * expected(n));
  }
}

TEST_F(ManyLamps, AChosenPlaceStandsForAllOfThem) {
  const Lamps all(scene);
  constexpr std::uint32_t kPlaces = 20000;
  float arrives = 0.f, wanted = 0.f;
  for (std::uint32_t k = 0; k < kPlaces; ++k) {
    const Vec3 u(r2_sequence(k), to_unit_float(hash(k)));
    const auto y = all.emitters.choose(Vec3(0.f), 0.1f, u);
    ASSERT_TRUE(y.has_value());
    const float squared = glm::dot(y->position, y->position);
    const float cosine = std::max(0.f, -glm::dot(y->normal, y->position)) / std::sqrt(squared);
    arrives += y->power.g * cosine / squared / kPlaces;
  }
  for (const Lamp& lamp : lamps) wanted += sent(lamp);
  EXPECT_NEAR(arrives, wanted, 0.03f * wanted);
}

}  // namespace
}  // namespace halflight
