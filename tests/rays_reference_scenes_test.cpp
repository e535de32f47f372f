// The path tracer against path-traced irradiance of another program, on real scenes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "halflight/io/load_scene.h"
#include "halflight/io/sensors.h"
#include "halflight/rays/reference_sensors.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

constexpr std::size_t kSensors = 250;
constexpr std::uint32_t kSamples = 1024;

struct StoredReading {
  float irradiance, standard_error;  // mean of the channels
};

std::vector<StoredReading> stored_readings(const std::filesystem::path& path) {
  std::vector<StoredReading> readings;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line) && readings.size() < kSensors;) {
    std::istringstream words(line);
    float skipped, r, g, b, error;
    for (int k = 0; k < 6; ++k) words >> skipped;
    words >> r >> g >> b >> error;
    readings.push_back({(r + g + b) / 3.f, error});
  }
  return readings;
}

class ReferenceScenes : public ::testing::TestWithParam<const char*> {};

TEST_P(ReferenceScenes, DifferFromTheStoredIrradianceByNoiseOnly) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const std::filesystem::path name = GetParam();
  const auto readings_file =
      shared_scenes() / "references" / (name.parent_path().string() + ".txt");
  Result<Scene> scene = load_scene(shared_scenes() / name);
  ASSERT_TRUE(scene) << scene.error().line();
  auto sensors = read_sensors(readings_file);
  ASSERT_TRUE(sensors) << sensors.error().line();
  sensors->resize(kSensors);
  std::vector<WorldSensor> in_world;
  for (const Sensor& s : *sensors) in_world.push_back(to_world(scene->to_world, s));

  const World world(std::move(*scene));
  const PathTracer tracer(world);
  const auto estimates = reference_irradiance(tracer, in_world, kSamples, 1, Progress());
  const auto stored = stored_readings(readings_file);
  double squares = 0.0, ours = 0.0, theirs = 0.0;
  for (std::size_t i = 0; i < kSensors; ++i) {
    const Rgb e = estimates[i].standard_error;
    const double noise = std::hypot(stored[i].standard_error, std::sqrt(glm::dot(e, e) / 3.f));
    const double deviation = (average(estimates[i].mean) - stored[i].irradiance) / noise;
    squares += std::min(deviation * deviation, 25.0);  // rare bright paths make heavy tails
    ours += average(estimates[i].mean);
    theirs += stored[i].irradiance;
  }
  // Chi-square of 250 sensors over 250 scatters by sqrt(2 / 250) = 9 %; standard errors from 16
  // batches, themselves noisy, add 15 % to its mean.
  EXPECT_LT(squares / kSensors, 1.6);
  EXPECT_GT(squares / kSensors, 0.5);
  EXPECT_NEAR(ours / theirs, 1.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ReferenceScenes,
                         ::testing::Values("cornell-box/CornellBox-Original.obj",
                                           "office-lbl/office-lbl.obj", "sponza/sponza.obj"));

}  // namespace
}  // namespace halflight
