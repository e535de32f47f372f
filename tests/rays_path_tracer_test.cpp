#include <gtest/gtest.h>

#include "halflight/base/parallel.h"
#include "halflight/rays/reference_sensors.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::corner_form_factor;
using testing::kDown;
using testing::kUp;
using testing::QuadScene;
using testing::Traced;

// Relative, for 2^14 stratified paths of these simple scenes: about four standard errors.
constexpr float kOnePercent = 0.01f;

TEST(PathTracer, FurnaceHoldsExitanceOverOneMinusReflectance) {
  QuadScene quads;
  const MaterialId wall = quads.material(0.5f, 1.f);
  quads.box(Vec3(0.f), Vec3(2.f, 1.f, 3.f), wall, true);
  quads.box(Vec3(0.5f, 0.2f, 0.5f), Vec3(0.9f, 0.6f, 1.f), wall, false);
  const Traced t(quads);
  const float expected = kPi / (1.f - 0.5f);
  EXPECT_NEAR(t.irradiance({1.5f, 0.f, 2.f}, kUp), expected, kOnePercent * expected);
  EXPECT_NEAR(t.irradiance({0.7f, 0.6f, 0.8f}, kUp), expected, kOnePercent * expected);
  EXPECT_NEAR(t.irradiance({0.7f, 0.2f, 0.8f}, kDown), expected, kOnePercent * expected);
}

// In a furnace every surface reflects rho E: paths that end there know the rest.
TEST(PathTracer, PathsMayEndWhereTheLightIsKnown) {
  QuadScene quads;
  quads.box(Vec3(0.f), Vec3(2.f, 1.f, 3.f), quads.material(0.5f, 1.f), true);
  const Traced t(quads);
  const float expected = kPi / (1.f - 0.5f);
  for (const float share : {1.f, 0.5f}) {  // of hits at which it is known
    double sum = 0.0;
    int ended = 0;
    constexpr int kPaths = 1 << 14;
    for (int i = 0; i < kPaths; ++i) {
      PathSampler sampler(7, static_cast<std::uint32_t>(i));
      const auto known = [&](const RayHit& hit) -> std::optional<Rgb> {
        if (hit.barycentric.x >= share) return std::nullopt;
        ++ended;
        return Rgb(0.5f * expected);
      };
      sum += static_cast<double>(
          average(t.tracer.irradiance_by_one_path({1.5f, 0.f, 2.f}, kUp, sampler, known)));
    }
    EXPECT_NEAR(sum / kPaths, static_cast<double>(expected), static_cast<double>(0.01f * expected));
    EXPECT_EQ(ended == kPaths, share == 1.f);
  }
}

TEST(PathTracer, BackSidesReflectAsFrontSidesDoAndDoubleSidedOnesShine) {
  QuadScene quads;
  quads.box(Vec3(0.f), Vec3(1.f), quads.material(0.8f, 1.f, true), false);
  const Traced t(quads);
  const float expected = kPi / (1.f - 0.8f);
  EXPECT_NEAR(t.irradiance({0.3f, 0.f, 0.6f}, kUp), expected, 2.f * kOnePercent * expected);
}

TEST(PathTracer, SquareLightGivesItsFormFactor) {
  QuadScene quads;
  quads.quad({-1.f, 2.f, -1.f}, {2.f, 0.f, 0.f}, {0.f, 0.f, 2.f}, quads.material(0.f, 3.f));
  const Traced t(quads);
  const float expected = 3.f * kPi * 4.f * corner_form_factor(1.f, 1.f, 2.f);
  EXPECT_NEAR(t.irradiance(Vec3(0.f), kUp), expected, kOnePercent * expected);
  const float near = 3.f * kPi * 4.f * corner_form_factor(1.f, 1.f, 0.01f);
  EXPECT_NEAR(t.irradiance({0.f, 1.99f, 0.f}, kUp), near, kOnePercent * near);
}

TEST(PathTracer, LightLeavesTheFrontSideAloneUnlessDoubleSided) {
  for (const bool double_sided : {false, true}) {
    QuadScene quads;
    quads.quad({-1.f, 0.f, -1.f}, {2.f, 0.f, 0.f}, {0.f, 0.f, 2.f},
               quads.material(0.f, 1.f, double_sided));
    const Traced t(quads);  // the front faces -Y
    const float lit = kPi * 4.f * corner_form_factor(1.f, 1.f, 1.f);
    EXPECT_NEAR(t.irradiance({0.f, -1.f, 0.f}, kUp), lit, kOnePercent * lit);
    EXPECT_NEAR(t.irradiance({0.f, 1.f, 0.f}, kDown), double_sided ? lit : 0.f, kOnePercent * lit);
  }
}

TEST(PathTracer, TexturedEmitterSendsItsMeanFromFarAway) {
  QuadScene quads;
  Texture stripes;
  stripes.width = 4;
  stripes.height = 1;
  stripes.texels = {{255, 255, 255, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}};
  Material m;
  m.reflectance = Rgb(0.f);
  m.emission = Rgb(8.f);
  m.emission_texture.texture = quads.scene.textures.push_back(stripes);
  quads.quad({-.5f, 20.f, -.5f}, {1.f, 0.f, 0.f}, {0.f, 0.f, 1.f},
             quads.scene.materials.push_back(m));
  const Traced t(quads);
  const float mean_radiance = 8.f / 4.f, solid_angle = 1.f / 400.f;
  EXPECT_NEAR(t.irradiance(Vec3(0.f), kUp), mean_radiance * solid_angle,
              kOnePercent * mean_radiance * solid_angle);
}

TEST(PathTracer, OneReflectionGivesTheProductOfFormFactors) {
  // A small lamp over a small white tile, seen by a sensor that the lamp's back is turned to.
  QuadScene quads;
  quads.quad({-.01f, 2.f, -.01f}, {.02f, 0.f, 0.f}, {0.f, 0.f, .02f}, quads.material(0.f, 1e4f));
  quads.quad({-.01f, 0.f, -.01f}, {0.f, 0.f, .02f}, {.02f, 0.f, 0.f}, quads.material(0.6f));
  const Traced t(quads);
  const float on_tile = 1e4f * 4e-4f / 4.f;
  const float radiance = 0.6f * on_tile / kPi;
  // At (3, 3, 0), facing the tile: cosine at the tile 3 / sqrt(18).
  const float expected = radiance * 4e-4f * (3.f / std::sqrt(18.f)) / 18.f;
  const Vec3 towards = glm::normalize(Vec3(-3.f, -3.f, 0.f));
  // Only the cosine-distributed ray can find the tile: few hits, so many samples and a wide bound.
  const IrradianceEstimate e = t.tracer.estimate_irradiance({3.f, 3.f, 0.f}, towards, 1u << 22, 3);
  EXPECT_NEAR(e.mean.g, expected, 5.f * e.standard_error.g);
  EXPECT_LT(e.standard_error.g, 0.2f * expected);
}

TEST(PathTracer, PointLightFallsWithTheSquareOfDistanceUpToItsRange) {
  QuadScene quads;
  Light lamp;
  lamp.intensity = Rgb(100.f);
  lamp.range = 10.f;
  quads.light_shining_down(lamp, {0.f, 5.f, 0.f});
  const Traced t(quads);
  const float window = 1.f - 1.f / 16.f;  // 1 - (5 / 10)^4
  EXPECT_NEAR(t.irradiance(Vec3(0.f), kUp, 4), 100.f / 25.f * window, 1e-4f);
  const float cosine = 4.f / 5.f;  // distance 5 again
  EXPECT_NEAR(t.irradiance({3.f, 1.f, 0.f}, kUp, 4), 100.f / 25.f * cosine * window, 1e-4f);
  EXPECT_EQ(t.irradiance({0.f, -6.f, 0.f}, kUp, 4), 0.f);
  EXPECT_EQ(t.irradiance(Vec3(0.f), kDown, 4), 0.f);
}

TEST(PathTracer, SpotFadesBetweenItsConesBySquareOfCosineRamp) {
  QuadScene quads;
  Light lamp;
  lamp.kind = Light::Kind::spot;
  lamp.intensity = Rgb(50.f);
  lamp.inner_cone_angle = std::acos(0.9f);
  lamp.outer_cone_angle = std::acos(0.7f);
  quads.light_shining_down(lamp, {0.f, 1.f, 0.f});
  const Traced t(quads);
  const auto at_cosine = [&](float cosine) {  // on the plane 1 m below: d = 1 / cosine
    const float x = std::sqrt(1.f / (cosine * cosine) - 1.f);
    return t.irradiance({x, 0.f, 0.f}, kUp, 4) / (cosine * cosine * cosine);
  };
  EXPECT_NEAR(at_cosine(0.95f), 50.f, 0.01f);
  EXPECT_NEAR(at_cosine(0.8f), 50.f * 0.25f, 0.01f);
  EXPECT_EQ(at_cosine(0.69f), 0.f);
}

TEST(PathTracer, DirectionalLightGivesItsIlluminanceTimesTheCosine) {
  QuadScene quads;
  Light sun;
  sun.kind = Light::Kind::directional;
  sun.intensity = Rgb(1000.f);
  quads.light_shining_down(sun, Vec3(0.f));
  quads.quad({-1.f, 1.f, -1.f}, {2.f, 0.f, 0.f}, {0.f, 0.f, 2.f}, quads.material(0.f));
  const Traced t(quads);
  EXPECT_NEAR(t.irradiance({5.f, 0.f, 0.f}, kUp, 4), 1000.f, 1e-3f);
  EXPECT_NEAR(t.irradiance({5.f, 0.f, 0.f}, {0.f, 0.6f, 0.8f}, 4), 600.f, 1e-3f);
  EXPECT_EQ(t.irradiance({0.f, 0.f, 0.f}, kUp, 4), 0.f);
  EXPECT_EQ(t.tracer.direct_visibility({5.f, 0.f, 0.f}, kUp, 4, 1), 1.f);
  EXPECT_EQ(t.tracer.direct_visibility({0.f, 0.f, 0.f}, kUp, 4, 1), 0.f);
}

TEST(PathTracer, OpenSkyGivesPiTimesItsRadiance) {
  QuadScene quads;
  quads.quad({-1.f, 0.f, -1.f}, {0.f, 0.f, 2.f}, {2.f, 0.f, 0.f}, quads.material(0.9f));
  quads.scene.sky = Rgb(2.f);
  const Traced t(quads);
  EXPECT_NEAR(t.irradiance({0.2f, 0.f, 0.1f}, kUp, 64), 2.f * kPi, 1e-5f);
  EXPECT_NEAR(t.irradiance({0.2f, 0.f, 0.1f}, kDown, 64), 2.f * kPi, 1e-5f);
}

TEST(PathTracer, PaneOfOpacityOneHalfHalvesDaylightAndLamplight) {
  QuadScene quads;
  quads.box(Vec3(-1.f), Vec3(1.f), quads.pane(0.5f), false);
  quads.scene.sky = Rgb(1.f);
  const float half_sky = 0.5f * kPi;
  EXPECT_NEAR(Traced(quads).irradiance(Vec3(0.f), kUp), half_sky, kOnePercent * half_sky);

  quads.scene.sky = Rgb(0.f);
  Light lamp;
  lamp.intensity = Rgb(8.f);
  quads.light_shining_down(lamp, {0.1f, 2.f, 0.f});
  EXPECT_NEAR(Traced(quads).irradiance({0.1f, 0.f, 0.f}, kUp, 4), 0.5f * 8.f / 4.f, 1e-5f);

  // An emitting pane shines with the share of its surface that is there.
  QuadScene lit;
  const MaterialId half = lit.pane(0.5f);
  lit.scene.materials[half].emission = Rgb(4.f);
  lit.quad({-1.f, 2.f, -1.f}, {2.f, 0.f, 0.f}, {0.f, 0.f, 2.f}, half);
  const float expected = 0.5f * 4.f * kPi * 4.f * corner_form_factor(1.f, 1.f, 2.f);
  EXPECT_NEAR(Traced(lit).irradiance(Vec3(0.f), kUp), expected, kOnePercent * expected);
}

TEST(PathTracer, ManyLampsAddUp) {
  QuadScene quads;
  const MaterialId dim = quads.material(0.f, 100.f), bright = quads.material(0.f, 2500.f);
  double expected = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 at(static_cast<float>(i % 20) - 8.f, 1.5f, static_cast<float>(i / 20) - 6.f);
    const bool is_bright = i % 7 == 0;
    quads.quad(at, {.02f, 0.f, 0.f}, {0.f, 0.f, .02f}, is_bright ? bright : dim);
    const double d2 = glm::dot(at, at);
    expected += (is_bright ? 2500.0 : 100.0) * 4e-4 * (1.5 * 1.5 / d2) / d2;
  }
  const Traced t(quads);
  const auto e = static_cast<float>(expected);
  EXPECT_NEAR(t.irradiance({.01f, 0.f, .01f}, kUp, 1u << 16), e, kOnePercent * e);
}

TEST(PathTracer, StandardErrorPredictsTheSpreadOverSeeds) {
  QuadScene quads;
  const MaterialId wall = quads.material(0.7f);
  quads.box(Vec3(0.f), Vec3(2.f), wall, true);
  quads.quad({.8f, 1.9f, .8f}, {.4f, 0.f, 0.f}, {0.f, 0.f, .4f}, quads.material(0.f, 10.f));
  const Traced t(quads);
  constexpr int kSeeds = 200;
  double sum = 0.0, squares = 0.0, variance = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto e = t.tracer.estimate_irradiance({.3f, 0.f, .4f}, kUp, 512, 1000 + seed);
    sum += e.mean.g;
    squares += double(e.mean.g) * e.mean.g;
    variance += double(e.standard_error.g) * e.standard_error.g;
  }
  const double spread = (squares - sum * sum / kSeeds) / (kSeeds - 1);
  // The ratio of the two variances scatters by about sqrt(2 / 200) = 10 %.
  EXPECT_NEAR(variance / kSeeds / spread, 1.0, 0.4);
}

TEST(PathTracer, DirectVisibilityIsTheUnhiddenShareOfTheLight) {
  QuadScene quads;
  quads.quad({-1.f, 2.f, -1.f}, {2.f, 0.f, 0.f}, {0.f, 0.f, 2.f}, quads.material(0.f, 1.f));
  // Covers the half of the light with x < 0, seen from the origin.
  quads.quad({-9.f, 1.f, -9.f}, {9.f, 0.f, 0.f}, {0.f, 0.f, 18.f}, quads.material(0.5f));
  const Traced t(quads);
  EXPECT_NEAR(t.tracer.direct_visibility(Vec3(0.f), kUp, 4096, 1), 0.5f, 0.02f);
  EXPECT_EQ(t.tracer.direct_visibility({2.f, 0.f, 0.f}, kUp, 64, 1), 1.f);
  EXPECT_EQ(t.tracer.direct_visibility({-4.f, 0.f, 0.f}, kUp, 64, 1), 0.f);
  EXPECT_EQ(t.tracer.direct_visibility({2.f, 0.f, 0.f}, kDown, 64, 1), 1.f);
}

TEST(PathTracer, SensorsGiveTheSameBytesForAnyThreadCount) {
  QuadScene quads;
  quads.box(Vec3(0.f), Vec3(2.f), quads.material(0.7f), true);
  quads.quad({.8f, 1.9f, .8f}, {.4f, 0.f, 0.f}, {0.f, 0.f, .4f}, quads.material(0.f, 10.f));
  std::vector<WorldSensor> sensors;
  for (int i = 1; i < 150; ++i)
    sensors.push_back({{0.013f * static_cast<float>(i), 0.f, 1.f}, kUp});
  const auto run = [&](int threads) {
    set_thread_count(threads);
    const Traced t(quads);
    return reference_irradiance(t.tracer, sensors, 32, 5, Progress());
  };
  const auto one = run(1), three = run(3);
  set_thread_count(0);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    EXPECT_EQ(one[i].mean, three[i].mean);
    EXPECT_EQ(one[i].standard_error, three[i].standard_error);
  }
}

// Each path asks one of them: what the other gives must not be lost.
TEST(PathTracer, TwoLampsGiveTheSumOfTheirLight) {
  QuadScene quads;
  quads.quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, quads.material(0.f));
  Light lamp;
  const Vec3 p(2.f, 0.f, 1.5f);
  float expected = 0.f;
  for (const auto& [intensity, place] :
       {std::pair(100.f, Vec3(1, 2, 1)), std::pair(30.f, Vec3(3, 1, 3))}) {
    lamp.intensity = Rgb(intensity);
    quads.light_shining_down(lamp, place);
    const float distance = glm::distance(p, place);
    expected += intensity * place.y / (distance * distance * distance);
  }
  EXPECT_NEAR(Traced(quads).irradiance(p, kUp), expected, 0.01f * expected);
}

}  // namespace
}  // namespace halflight
