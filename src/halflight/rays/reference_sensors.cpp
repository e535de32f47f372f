#include "halflight/rays/reference_sensors.h"

#include "halflight/base/parallel.h"
#include "halflight/rays/sensor_placement.h"

namespace halflight {

constexpr std::size_t kSensorsPerReport = 64;

std::vector<IrradianceEstimate> reference_irradiance(const PathTracer& tracer,
                                                     std::span<const WorldSensor> sensors,
                                                     std::uint32_t samples_per_sensor,
                                                     std::uint64_t seed, const Progress& progress) {
  std::vector<IrradianceEstimate> estimates(sensors.size(), {Rgb(0.f), Rgb(kInfinity)});
  for (std::size_t first = 0; first < sensors.size(); first += kSensorsPerReport) {
    if (progress.cancelled()) break;
    const std::size_t count = std::min(kSensorsPerReport, sensors.size() - first);
    parallel_for(count, 1, [&](std::size_t k) {
      const std::size_t i = first + k;
      const SensorPlacement at = place_sensor(tracer.world().geometry, tracer.world().rays,
                                              sensors[i].position, sensors[i].normal);
      estimates[i] =
          tracer.estimate_irradiance(at.position, at.normal, samples_per_sensor, hash(seed, i));
    });
    progress.report("sensors",
                    static_cast<double>(first + count) / static_cast<double>(sensors.size()));
  }
  return estimates;
}

}  // namespace halflight
