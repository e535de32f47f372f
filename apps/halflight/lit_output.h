// -o and --lightmap of what solves, mixes or samples: the lit scene of a solution.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <CLI/App.hpp>

#include "command_files.h"
#include "halflight/base/progress.h"
#include "halflight/base/result.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/report.h"
#include "halflight/solve/solver.h"
#include "sensor_arguments.h"

namespace halflight::app {

struct LitArguments {
  std::filesystem::path path;           // empty: none is wanted
  std::optional<std::string> lightmap;  // texels a side
};

void add_lit_arguments(CLI::App& command, LitArguments& arguments);
// Tells of bad arguments before any work is done.
Result<void> check(const LitArguments& arguments);

// The lit scene, and the pictures of the lightmap beside it.
void add_files(CommandFiles& files, const LitArguments& arguments);

// Bytes that writing takes at least, for scenes of so many vertices.
std::size_t least_memory(const LitArguments& arguments, std::size_t vertices);

// As fine as the light asks for and a limit on memory allows.
LitMeshOptions lit_mesh_options(const SolverState& state, const LitArguments& arguments = {});

// Writes lit.glb and, with a lightmap, lit.lightmap.exr (irradiance) and lit.lightmap.png (to look
// at) beside it. Also tells the report how long it took and what they are like. When there is no
// room for a lightmap the lit scene is written without.
Result<void> write_lit(const LitArguments& arguments, const SolverState& state, Report& report,
                       const Progress& progress);

// What is read from a solution that is there already: sensors if any are given, the lit scene if it
// is wanted.
Result<void> write_readings(const SensorArguments& sensor_arguments,
                            std::span<const Sensor> sensors, const LitArguments& lit,
                            const SolverState& state);

}  // namespace halflight::app
