// --points and --points-out, and the light of a solution at what they name.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "command_files.h"
#include "halflight/base/result.h"
#include "halflight/io/sensors.h"
#include "halflight/solve/solver.h"

namespace halflight::app {

struct SensorArguments {
  std::filesystem::path points;
  std::filesystem::path points_out;
  std::string final_gather = "auto";
};

// Returns the option --points. `arguments` must live until the command has run.
CLI::Option* add_sensor_arguments(CLI::App& command, SensorArguments& arguments);

void add_files(CommandFiles& files, const SensorArguments& arguments);
// Tells of options that only matter where there are sensors.
void warn_of_idle_sensors(const CLI::App& command);

// None without --points. Errors: --final-gather is no number; what is wrong with the file.
Result<std::vector<Sensor>> read_sensors(const SensorArguments& arguments);

// Writes the irradiance at the sensors.
Result<void> write_irradiance(const SensorArguments& arguments, const SolverState& state,
                              std::span<const Sensor> sensors);

}  // namespace halflight::app
