#include "sensor_arguments.h"

#include "halflight/base/parallel.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/sensor_placement.h"

namespace halflight::app {

CLI::Option* add_sensor_arguments(CLI::App& command, SensorArguments& arguments) {
  CLI::Option* points =
      command.add_option("--points", arguments.points, "sensors: lines \"x y z nx ny nz\"")
          ->type_name("FILE");
  command
      .add_option("--points-out", arguments.points_out,
                  "the sensors with \"Er Eg Eb\" added; standard output without it")
      ->type_name("FILE")
      ->needs(points);
  return points;
}

Result<std::vector<Sensor>> read_sensors(const SensorArguments& arguments) {
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
  std::vector<Rgb> irradiance;
  for (const Reading& reading : SolutionReader(state, sensor_reading(state))(points))
    irradiance.push_back(reading.irradiance());
  return write_sensor_table(arguments.points_out, sensor_table(sensors, irradiance));
}

}  // namespace halflight::app
