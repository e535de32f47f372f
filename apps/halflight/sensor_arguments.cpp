#include "sensor_arguments.h"

#include <fmt/format.h>

#include "halflight/base/parallel.h"
#include "halflight/base/quantities.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/sensor_placement.h"
#include "idle_options.h"

namespace halflight::app {
namespace {

constexpr double kMostGatherRays = 1 << 20;

// Negative: by the error aimed at.
Result<int> resolve_gather_rays(const std::string& wish) {
  if (wish == "auto") return -1;
  const Result<double> rays = parse_count(wish);
  if (!rays || !(*rays >= 0.0 && *rays <= kMostGatherRays))
    return input_error(fmt::format("--final-gather '{}' is neither auto nor a count", wish), {},
                       fmt::format("write auto, 0, or a number up to {}", kMostGatherRays));
  return static_cast<int>(*rays);
}

}  // namespace

CLI::Option* add_sensor_arguments(CLI::App& command, SensorArguments& arguments) {
  CLI::Option* points =
      command.add_option("--points", arguments.points, "sensors: lines \"x y z nx ny nz\"")
          ->check(file_name())
          ->type_name("FILE");
  command
      .add_option("--points-out", arguments.points_out,
                  "the sensors with \"Er Eg Eb\" added; standard output without it")
      ->check(file_name())
      ->type_name("FILE")
      ->needs(points);
  command
      .add_option("--final-gather", arguments.final_gather,
                  "rays by which each sensor looks for indirect light; 0: what was found for the "
                  "cell it lies in, much faster; auto: by the error aimed at")
      ->type_name("auto|N")
      ->capture_default_str();
  return points;
}

void add_files(CommandFiles& files, const SensorArguments& arguments) {
  files.reads("the sensors", arguments.points);
  files.writes("--points-out", arguments.points_out);
}

void warn_of_idle_sensors(const CLI::App& command) {
  if (command.get_option("--points")->count() == 0)
    warn_of_idle(command, {"--final-gather"}, "without --points");
}

Result<std::vector<Sensor>> read_sensors(const SensorArguments& arguments) {
  if (const auto rays = resolve_gather_rays(arguments.final_gather); !rays)
    return tl::unexpected(rays.error());
  if (arguments.points.empty()) return std::vector<Sensor>();
  return halflight::read_sensors(arguments.points);
}

Result<void> write_irradiance(const SensorArguments& arguments, const SolverState& state,
                              std::span<const Sensor> sensors) {
  const World& world = *state.world;
  std::vector<ReadingPoint> points(sensors.size());
  parallel_for(sensors.size(), 64, [&](std::size_t i) {
    const WorldSensor sensor = to_world(world.scene.to_world, sensors[i]);
    const SensorPlacement placed =
        place_sensor(world.geometry, world.rays, sensor.position, sensor.normal);
    points[i] = {placed.position, placed.normal, placed.triangle};
  });
  ReadOptions options = sensor_reading(state);
  const Result<int> rays = resolve_gather_rays(arguments.final_gather);
  if (!rays) return tl::unexpected(rays.error());
  if (*rays >= 0) options.gather_rays = *rays;
  std::vector<Rgb> irradiance;
  for (const Reading& reading : SolutionReader(state, options)(points))
    irradiance.push_back(reading.irradiance());
  return write_sensor_table(arguments.points_out, sensor_table(sensors, irradiance));
}

}  // namespace halflight::app
