// halflight solve: the main job, light a scene.
#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/base/quantities.h"
#include "halflight/io/atomic_file.h"
#include "halflight/io/sensors.h"
#include "halflight/output/exposure.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/read_light.h"
#include "halflight/output/report.h"
#include "halflight/rays/sensor_placement.h"
#include "interrupt.h"
#include "scene_arguments.h"
#include "solve_arguments.h"
#include "solve_run.h"

namespace halflight::app {
namespace {

struct Outputs {
  std::filesystem::path lit;
  std::filesystem::path points;
  std::filesystem::path points_out;
  std::filesystem::path report;
};

struct SolveCommand {
  SceneArguments scene;
  SolveArguments solve;
  Outputs outputs;
};

std::vector<Rgb> read_sensors_at(const SolutionReader& reader, const World& world,
                                 std::span<const Sensor> sensors) {
  std::vector<ReadingPoint> points(sensors.size());
  parallel_for(sensors.size(), 64, [&](std::size_t i) {
    const WorldSensor sensor = to_world(world.scene.to_world, sensors[i]);
    const SensorPlacement placed =
        place_sensor(world.geometry, world.rays, sensor.position, sensor.normal);
    points[i] = {placed.position, placed.normal, placed.triangle};
  });
  const std::vector<Reading> readings = reader(points);
  std::vector<Rgb> irradiance(readings.size());
  for (std::size_t i = 0; i < readings.size(); ++i) irradiance[i] = readings[i].irradiance();
  return irradiance;
}

Result<void> write_lit(const std::filesystem::path& path, const SolverState& state, Report& report,
                       const Progress& progress) {
  const World& world = *state.world;
  const SolutionReader reader(state, kMeshReading);
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  options.finest = finest_mesh_edge(state);
  const auto start = std::chrono::steady_clock::now();
  const LitMesh mesh = build_lit_mesh(
      world.scene, world.geometry,
      [&](std::span<const ReadingPoint> points) { return reader(points, progress); }, options,
      progress);
  report.end_phase("lit mesh", start);
  const float exposure = automatic_exposure(world.scene, world.geometry, mesh.primitives);
  auto written = write_lit_glb(path, world.scene, world.geometry, mesh.primitives, exposure);
  report.end_phase("write lit", start);
  report.set_lit_mesh(mesh, exposure);
  return written;
}

void warn_without_output(const Outputs& outputs) {
  if (outputs.lit.empty() && outputs.points.empty() && outputs.report.empty())
    std::fputs(
        "halflight: warning: nothing will be written (add -o lit.glb, --points or --report)\n",
        stderr);
}

Result<int> run(const SolveCommand& command) {
  Report report;
  const auto start = std::chrono::steady_clock::now();
  Result<SolvePlan> plan = resolve(command.solve);
  if (!plan) return tl::unexpected(plan.error());
  std::vector<Sensor> sensors;
  if (!command.outputs.points.empty()) {
    auto read = read_sensors(command.outputs.points);
    if (!read) return tl::unexpected(read.error());
    sensors = std::move(*read);
  }
  Result<Scene> scene = load(command.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  warn_without_output(command.outputs);
  report.end_phase("load", start);

  auto phase = std::chrono::steady_clock::now();
  const auto world = make_world(std::move(*scene));
  report.end_phase("rays", phase);
  if (auto ok = complete(*plan, command.solve, *world); !ok) return tl::unexpected(ok.error());

  Progress progress(progress_listener(command.solve));
  const Interruptible interruptible(progress);
  const Deadline deadline(progress, command.solve, start);
  phase = std::chrono::steady_clock::now();
  SolverState state = make_state(world, plan->options);
  report.end_phase("hierarchy", phase);
  phase = std::chrono::steady_clock::now();
  const SolveOutcome outcome =
      run_to_goal(state, plan->goals, deadline, progress, !command.outputs.report.empty());
  report.end_phase("solve", phase);

  if (!sensors.empty()) {
    phase = std::chrono::steady_clock::now();
    const std::vector<Rgb> irradiance =
        read_sensors_at(SolutionReader(state, sensor_reading(state)), *world, sensors);
    auto written =
        write_sensor_table(command.outputs.points_out, sensor_table(sensors, irradiance));
    if (!written) return tl::unexpected(written.error());
    report.end_phase("sensors", phase);
  }
  if (!command.outputs.lit.empty()) {
    auto written = write_lit(command.outputs.lit, state, report, progress);
    if (!written) return tl::unexpected(written.error());
  }
  // Cancelled, iterations and the mesh end early: what is written is valid, and coarser.
  const int status = interruptible.interrupted()                 ? kInterrupted
                     : progress.cancelled() || !outcome.goal_met ? kBudgetEnded
                                                                 : kGoalMet;
  if (outcome.error) report.set_estimated_error(*outcome.error);
  if (!command.outputs.report.empty()) {
    auto written = write_text_atomically(command.outputs.report, report.json(state));
    if (!written) return tl::unexpected(written.error());
  }
  return status;
}

}  // namespace

void add_solve(CLI::App& cli, int& status) {
  auto command = std::make_shared<SolveCommand>();
  CLI::App& sub = *cli.add_subcommand("solve", "light a scene");
  add_scene_arguments(sub, command->scene);
  add_solve_arguments(sub, command->solve);
  sub.add_option("-o,--output", command->outputs.lit, "lit scene, GLB")->type_name("lit.glb");
  CLI::Option* points =
      sub.add_option("--points", command->outputs.points, "sensors: lines \"x y z nx ny nz\"")
          ->type_name("FILE");
  sub.add_option("--points-out", command->outputs.points_out,
                 "the sensors with \"Er Eg Eb\" added; standard output without it")
      ->type_name("FILE")
      ->needs(points);
  sub.add_option("--report", command->outputs.report, "what was done, JSON")->type_name("FILE");
  sub.callback([command, &status] {
    set_thread_count(command->solve.threads);
    const Result<int> done = run(*command);
    status = done ? *done : fail(done.error());
  });
}

}  // namespace halflight::app
