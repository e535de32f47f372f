// What the feature size saves and costs: whole solutions as s grows. FBEM(s) of the light on floor
// and furniture, seen from above, against path tracing, beside that of the solution without a gate
// at the same s; and the error at the sensors of a reference file, where there is one.
//
//   bench_gate office-lbl soda-shop kitchen     scenes of ../shared/scenes
//   bench_gate office.glb                       or files
//
// s is a share of the scene's diagonal; 0.1 % stands for no gate. Errors are shares of the mean
// irradiance, less (in the square) those that the noise of the path-traced picture makes: half the
// FBEM(s) between two pictures of half the paths.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <locale>
#include <sstream>

#include "experiments/feature_study.h"
#include "halflight/io/load_scene.h"
#include "halflight/io/sensors.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/sensor_placement.h"

namespace halflight::experiments {
namespace {

constexpr std::array kShares{0.001, 0.01, 0.02, 0.05, 0.1};
constexpr int kPixels = 96;
constexpr float kFromHeight = 0.75f;     // of the scene's
constexpr std::uint32_t kSamples = 256;  // of each of two pictures
constexpr std::uint32_t kMaskSamples = 32;
const std::filesystem::path kScenes = "../shared/scenes";

struct Commas : std::numpunct<char> {
  char do_thousands_sep() const override { return ','; }
  std::string do_grouping() const override { return "\3"; }
};
const std::locale kThousands(std::locale::classic(), new Commas);

Result<std::shared_ptr<const World>> load_world(const std::string& name) {
  std::filesystem::path file = name;
  if (!std::filesystem::is_regular_file(file))
    for (const char* ending : {".obj", ".glb", ".gltf"})
      if (const auto known = kScenes / name / (name + ending); std::filesystem::exists(known))
        file = known;
  Result<Scene> scene = load_scene(file);
  if (!scene) return tl::unexpected(scene.error());
  return make_world(std::move(*scene));
}

// Sensors with their irradiance in the columns after the sixth; a view whose pixels they are.
struct KnownSensors {
  FlatView view;
  std::vector<float> irradiance;
};
KnownSensors known_sensors(const World& world, const std::filesystem::path& path) {
  KnownSensors known;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream numbers(line);
    Sensor sensor;
    Rgb e;
    if (!(numbers >> sensor.position.x >> sensor.position.y >> sensor.position.z >>
          sensor.normal.x >> sensor.normal.y >> sensor.normal.z >> e.r >> e.g >> e.b))
      continue;
    const WorldSensor there = to_world(world.scene.to_world, sensor);
    const SensorPlacement at =
        place_sensor(world.geometry, world.rays, there.position, there.normal);
    known.view.points.push_back({at.position, at.normal, at.triangle});
    known.irradiance.push_back(average(e));
  }
  known.view.width = static_cast<int>(known.irradiance.size());
  known.view.height = 1;
  return known;
}

std::string median_and_p90(const KnownSensors& known, const Image& read) {
  if (known.irradiance.empty()) return "- | -";
  float mean = 0.f;
  for (const float e : known.irradiance) mean += e / static_cast<float>(known.irradiance.size());
  std::vector<float> errors;
  for (std::size_t i = 0; i < known.irradiance.size(); ++i)
    errors.push_back(std::abs(average(read.pixels[i]) - known.irradiance[i]) /
                     std::max(known.irradiance[i], 0.01f * mean));
  std::sort(errors.begin(), errors.end());
  return fmt::format("{:.2f} % | {:.1f} %", 100.f * errors[errors.size() / 2],
                     100.f * errors[9 * errors.size() / 10]);
}

Image mean_of(const Image& a, const Image& b) {
  Image mean = a;
  for (std::size_t i = 0; i < mean.pixels.size(); ++i)
    mean.pixels[i] = 0.5f * (a.pixels[i] + b.pixels[i]);
  return mean;
}

double without_noise(double error, double noise) {
  return std::sqrt(std::max(0.0, error * error - noise * noise));
}

Result<void> report(const std::string& name) {
  const auto loaded = load_world(name);
  if (!loaded) return tl::unexpected(loaded.error());
  const std::shared_ptr<const World>& world = *loaded;
  const PathTracer tracer(*world);
  const FlatView floor = view_of_floor(*world, kFromHeight, kPixels);
  const BinaryImage shadow = shadow_in(floor, tracer, kMaskSamples);
  const Image first = traced_picture(floor, tracer, kSamples, 1);
  const Image second = traced_picture(floor, tracer, kSamples, 2);
  const Image reference = mean_of(first, second);
  const KnownSensors sensors = known_sensors(
      *world, kScenes / "references" / (std::filesystem::path(name).stem().string() + ".txt"));
  const std::string title = std::filesystem::path(name).stem().string();
  Image ungated;
  for (const double share : kShares) {
    SolveOptions options;
    options.feature_size = static_cast<float>(share) * world->geometry.bounds.diagonal();
    const StudySolution s = solve_and_look(world, options, {floor, sensors.view}, {}, Progress());
    const Image& picture = s.pictures.front();
    if (ungated.pixels.empty()) ungated = picture;
    const double noise = 0.5 * judge(floor, first, second, shadow, s.feature_size).fbem;
    const double gated =
        without_noise(judge(floor, reference, picture, shadow, s.feature_size).fbem, noise);
    const StudyError judged = judge(floor, reference, ungated, shadow, s.feature_size);
    const double before = without_noise(judged.fbem, noise);
    const std::string row = fmt::format(
        kThousands,
        "| {} | {:.1f} % | {:L} | {:L} | {:L} | {:.2f} | {:.2f} % | {:.2f} % | {:.2f} | "
        "{:.0f} % | {:.2f} % | {} |\n",
        title, 100.0 * share, s.cost.elements, s.cost.links, s.cost.rays, s.cost.cpu_seconds,
        100.0 * gated, 100.0 * before, gated / before, 100.0 * judged.mask_share, 100.0 * noise,
        median_and_p90(sensors, s.pictures.back()));
    std::fputs(row.c_str(), stdout);
    std::fflush(stdout);
  }
  return {};
}

}  // namespace
}  // namespace halflight::experiments

int main(int count, char** arguments) {
  fmt::print(
      "| scene | s | elements | links | rays | CPU s | FBEM(s) | no gate | ratio | features | "
      "noise | median | 90th percentile "
      "|\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (int i = 1; i < count; ++i)
    if (const auto done = halflight::experiments::report(arguments[i]); !done) {
      fmt::print(stderr, "{}: {}\n", arguments[i], done.error().what);
      return 1;
    }
  return 0;
}
