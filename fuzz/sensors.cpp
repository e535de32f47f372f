// Sensor files; what was read is written and read again.
#include <vector>

#include "fuzz_target.h"
#include "halflight/io/sensors.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  const auto sensors = parse_sensors(fuzz::text_of(data, size), "sensors.txt");
  if (!sensors) {
    fuzz::require_clear(sensors.error());
    return 0;
  }
  for (const Sensor& sensor : *sensors) {
    const WorldSensor placed = to_world(Mat4(1.0), sensor);
    fuzz::require(is_finite(placed.position), "sensors are somewhere");
    fuzz::require(std::abs(glm::length(placed.normal) - 1.f) < 1e-5f, "normals are unit");
  }
  const std::vector<Rgb> irradiance(sensors->size(), Rgb(1.f));
  const auto again = parse_sensors(sensor_table(*sensors, irradiance), "table");
  fuzz::require(again && again->size() == sensors->size(), "a table can be read again");
  for (std::size_t i = 0; i < again->size(); ++i)
    fuzz::require((*again)[i].position == (*sensors)[i].position, "a table keeps what was read");
  return 0;
}
