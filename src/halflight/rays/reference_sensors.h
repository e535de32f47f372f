// Path-traced irradiance at many sensors, in parallel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/io/sensors.h"
#include "halflight/rays/path_tracer.h"

namespace halflight {

// Estimates in the order of the sensors; sensor i has the seed hash(seed, i). When cancelled, the
// sensors that were not reached keep an infinite standard error.
std::vector<IrradianceEstimate> reference_irradiance(const PathTracer& tracer,
                                                     std::span<const WorldSensor> sensors,
                                                     std::uint32_t samples_per_sensor,
                                                     std::uint64_t seed, const Progress& progress);

}  // namespace halflight
