// Cosine-weighted means over the hemisphere, against closed forms, and how many rays they take.
#include <gtest/gtest.h>

#include "closed_forms.h"
#include "halflight/rays/adaptive_hemisphere.h"

namespace halflight {
namespace {

constexpr int kRays = 1024;

template <class Seen>
float mean(const Seen& seen, int* asked = nullptr) {
  int count = 0;
  const Rgb sum = adaptive_cosine_mean(kRays, Vec2(0.5f), [&](const Vec3& w, float rays) {
    EXPECT_NEAR(glm::length(w), 1.f, 1e-5f);
    EXPECT_GE(w.z, 0.f);
    EXPECT_GE(rays, 1024.f);
    ++count;
    return Rgb(seen(w));
  });
  if (asked) *asked = count;
  return sum.g;
}

TEST(AdaptiveHemisphere, AnEvenSkyTakesNoFurtherRays) {
  int asked = 0;
  EXPECT_NEAR(mean([](const Vec3&) { return 3.f; }, &asked), 3.f, 1e-5f);
  EXPECT_EQ(asked, kRays);
}

// The mean of cos^2 over a cosine-distributed hemisphere is 1/2, of x^2 1/4.
TEST(AdaptiveHemisphere, SmoothLightIsIntegratedWithTheCosine) {
  EXPECT_NEAR(mean([](const Vec3& w) { return w.z * w.z; }), 0.5f, 1e-3f);
  EXPECT_NEAR(mean([](const Vec3& w) { return w.x * w.x; }), 0.25f, 1e-3f);
  EXPECT_NEAR(mean([](const Vec3& w) { return w.y * w.y; }), 0.25f, 1e-3f);
}

// One ray in twenty meets a light of 20: where the rays go must have nothing to do with that.
TEST(AdaptiveHemisphere, NoiseBesideItsGuideLeavesNoBias) {
  const auto mean_of_many = [](bool guided) {
    double sum = 0.0;
    constexpr int kTimes = 400;
    for (int i = 0; i < kTimes; ++i) {
      int ray = 0;
      const auto seen = [&](const Vec3&, float) -> SeenLight {
        const Rgb noisy(to_unit_float(hash(i, ++ray, 7)) < 0.05f ? 20.f : 0.f);
        return guided ? SeenLight(noisy, Rgb(1.f)) : SeenLight(noisy);
      };
      sum += static_cast<double>(adaptive_cosine_mean(kRays, Vec2(0.5f), seen).g);
    }
    return sum / kTimes;
  };
  EXPECT_NEAR(mean_of_many(true), 1.0, 0.02);
  EXPECT_LT(mean_of_many(false), 0.95);  // what the guide is for
}

// Windows at height 1, from a quarter of the view to less than one ray in a hundred, and a slit.
TEST(AdaptiveHemisphere, WindowsHaveTheirConfigurationFactor) {
  struct Window {
    double x, y, width, depth, tolerance;
  };
  for (const Window& o : {Window{0.1, -0.3, 1.0, 0.8, 0.01}, Window{1.0, 0.5, 0.3, 0.3, 0.03},
                          Window{-2.0, 0.4, 3.0, 0.05, 0.1}}) {
    int asked = 0;
    const float found = mean(
        [&](const Vec3& w) {
          const double x = static_cast<double>(w.x / w.z), y = static_cast<double>(w.y / w.z);
          return x > o.x && x < o.x + o.width && y > o.y && y < o.y + o.depth ? 1.f : 0.f;
        },
        &asked);
    const double exact = testing::configuration_factor(
        {0, 0, 0}, {0, 0, 1}, testing::rectangle({o.x, o.y, 1}, {o.width, 0, 0}, {0, o.depth, 0}));
    EXPECT_NEAR(found / exact, 1.0, o.tolerance) << exact;
    EXPECT_GT(asked, kRays);
    EXPECT_LT(asked, 2 * kRays + 100);
  }
}

}  // namespace
}  // namespace halflight
