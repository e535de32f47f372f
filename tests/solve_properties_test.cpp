// What holds of any scene, however odd: light is finite and never negative, none is made, twice the
// emission is twice the light, threads do not matter, nor where the scene stands.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include <rapidcheck/gtest.h>
#include <rapidcheck/shrinkable/Operations.h>
#include <glm/ext/matrix_transform.hpp>

#include "halflight/base/parallel.h"
#include "random_scenes.h"

namespace halflight {
namespace {

using namespace testing;

// Of solves with an error of 10 % and features as large as whole parts. Refined links lose what
// their errors are.
float coarse(const RandomSettings& settings) {
  return settings.links == LinkMaker::sampled ? 0.1f : 0.25f;
}
constexpr ReadOptions kReading{.gather_rays = 256, .direct = {}};

// On surfaces, and in the air.
std::vector<ReadingPoint> reading_points(const SolverState& state) {
  std::vector<ReadingPoint> points = scatter_points(state, 12);
  for (const float y : {0.1f, 1.4f, 2.9f}) {
    points.push_back({{1.9f, y, 2.1f}, kUp, {}, false});
    points.push_back({{0.7f, y, 3.3f}, kDown, {}, false});
  }
  return points;
}

struct Light3 {
  std::vector<Rgb> radiosity, irradiance, readings;
};

Light3 light_of(const Scene& scene, const RandomSettings& settings) {
  const SolverState state = solve(scene, settings.options());
  Light3 light{state.radiosity.raw(), state.irradiance.raw(), {}};
  for (const Reading& r : SolutionReader(state, kReading)(reading_points(state))) {
    light.readings.push_back(r.direct);
    light.readings.push_back(r.indirect);
  }
  return light;
}

void require_sound(const std::vector<Rgb>& light) {
  for (const Rgb& e : light)
    for (int channel = 0; channel < 3; ++channel) {
      RC_ASSERT(std::isfinite(e[channel]));
      RC_ASSERT(e[channel] >= 0.f);
    }
}

TEST(AnyScene, LightIsFiniteAndNeverNegative) {
  rc::detail::checkGTest([] {
    const RandomScene random = *random_scene({.wrong = true}).as("scene");
    const RandomSettings settings = *random_settings().as("settings");
    const Light3 light = light_of(build(random), settings);
    require_sound(light.radiosity);
    require_sound(light.irradiance);
    require_sound(light.readings);
  });
}

TEST(AnyScene, NoLightIsMade) {
  rc::detail::checkGTest([] {
    const RandomScene random = *random_scene({.wrong = true}).as("scene");
    const RandomSettings settings = *random_settings().as("settings");
    const EnergyBalance balance = energy_balance(solve(build(random), settings.options()));
    RC_LOG() << "emitted " << balance.emitted.g << ", absorbed " << balance.absorbed.g;
    RC_ASSERT(std::isfinite(balance.emitted.g));
    RC_ASSERT(balance.absorbed.g >= 0.f);
    RC_ASSERT(balance.absorbed.g <= 1.05f * balance.emitted.g);
  });
}

TEST(AnyScene, AClosedRoomAbsorbsAllThatIsEmitted) {
  rc::detail::checkGTest([] {
    const RandomScene random = *random_scene({.closed = true}).as("scene");
    RandomSettings settings = *random_settings().as("settings");
    settings.intra_cluster = true;  // without, clusters may create light
    const EnergyBalance balance = energy_balance(solve(build(random), settings.options()));
    RC_PRE(balance.emitted.g > 0.f);
    RC_LOG() << "emitted " << balance.emitted.g << ", absorbed " << balance.absorbed.g;
    RC_ASSERT(std::abs(balance.absorbed.g / balance.emitted.g - 1.f) < coarse(settings));
  });
}

// By a power of two, so that not a bit of any mantissa changes.
TEST(AnyScene, FourTimesTheEmissionIsFourTimesTheLight) {
  rc::detail::checkGTest([] {
    const RandomScene random = *random_scene({}).as("scene");
    const RandomSettings settings = *random_settings().as("settings");
    Scene scene = build(random);
    const Light3 once = light_of(scene, settings);
    for (Material& m : scene.materials) m.emission *= 4.f;
    for (halflight::Light& l : scene.lights) l.intensity *= 4.f;
    scene.sky *= 4.f;
    const Light3 four = light_of(scene, settings);
    const auto require_four = [](const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
      RC_ASSERT(a.size() == b.size());
      for (std::size_t i = 0; i < a.size(); ++i) RC_ASSERT(4.f * a[i] == b[i]);
    };
    require_four(once.irradiance, four.irradiance);
    require_four(once.radiosity, four.radiosity);
    require_four(once.readings, four.readings);
  });
}

TEST(AnyScene, ThreadsChangeNotABit) {
  rc::detail::checkGTest([] {
    const Scene scene = build(*random_scene({.wrong = true}).as("scene"));
    const RandomSettings settings = *random_settings().as("settings");
    const auto with_threads = [&](int threads) {
      set_thread_count(threads);
      const Light3 light = light_of(scene, settings);
      set_thread_count(0);
      return light;
    };
    const auto same = [](const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
    };
    const Light3 one = with_threads(1);
    for (const int threads : {2, 4}) {
      const Light3 more = with_threads(threads);
      RC_ASSERT(same(one.radiosity, more.radiosity));
      RC_ASSERT(same(one.irradiance, more.irradiance));
      RC_ASSERT(same(one.readings, more.readings));
    }
  });
}

// Turned about an oblique axis and carried away: grids and rays fall elsewhere, light does not.
TEST(AnyScene, ARigidMotionChangesLittle) {
  rc::detail::checkGTest([] {
    const RandomScene random = *random_scene({.closed = true}).as("scene");
    RandomSettings settings = *random_settings().as("settings");
    settings.intra_cluster = true;  // without, clusters may create light
    Scene scene = build(random);
    const auto measure = [&](const Mat4& motion) {
      scene.to_world = motion;
      const SolverState state = solve(scene, settings.options());
      const EnergyBalance balance = energy_balance(state);
      const SolutionReader reader(state, kReading);
      float read = 0.f;
      for (const Vec3 at : {Vec3(0.1f, 0.1f, 2.f), Vec3(2.f, 2.9f, 0.1f), Vec3(3.9f, 0.2f, 3.f)})
        for (const Vec3& n : {kUp, kDown, Vec3(0, 0, 1)})
          read += average(
              reader.read({transform_point(motion, at), transform_vector(motion, n), {}, false})
                  .irradiance());
      return std::array{balance.emitted.g, balance.absorbed.g, read};
    };
    const auto before = measure(Mat4(1.0));
    RC_PRE(before[2] > 0.f);
    const auto after = measure(glm::translate(Mat4(1.0), glm::dvec3(20, -7, 11)) *
                               glm::rotate(Mat4(1.0), 0.9, glm::normalize(glm::dvec3(1, 2, 3))));
    for (std::size_t i = 0; i < 3; ++i) {
      RC_LOG() << before[i] << " before, " << after[i] << " after\n";
      RC_ASSERT(std::abs(after[i] / before[i] - 1.f) < 2.f * coarse(settings));
    }
  });
}

// Failures are told as few plain parts: from any scene with a ball one is found that is nothing but
// a ball, with every number at its least.
TEST(AnyScene, ScenesShrink) {
  const auto has_ball = [](const RandomScene& s) {
    return std::any_of(s.parts.begin(), s.parts.end(),
                       [](const RandomPart& p) { return p.kind == Part::ball; });
  };
  int shrunk = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto scene = random_scene({.wrong = true})(rc::Random(seed), 20);
    if (!has_ball(scene.value()) || scene.value().parts.size() < 3) continue;
    const RandomScene least = rc::shrinkable::findLocalMin(scene, has_ball).first;
    ASSERT_EQ(least.parts.size(), 1u);
    EXPECT_EQ(least.parts[0].kind, Part::ball);
    EXPECT_EQ(least.parts[0].width, 1);
    EXPECT_EQ(least.parts[0].reflectance, 0);
    EXPECT_TRUE(least.lamps.empty());
    ++shrunk;
  }
  EXPECT_GT(shrunk, 5);
}

}  // namespace
}  // namespace halflight
