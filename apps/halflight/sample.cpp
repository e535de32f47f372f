// halflight sample CHECKPOINT: irradiance at sensors of a scene that was solved, or all of it lit.
#include <memory>

#include "checkpoint_arguments.h"
#include "commands.h"
#include "halflight/base/parallel.h"
#include "lit_output.h"
#include "number_checks.h"
#include "sensor_arguments.h"

namespace halflight::app {
namespace {

struct SampleArguments {
  CheckpointArguments checkpoint;
  SensorArguments sensors;
  LitArguments lit;
  int threads = 0;
};

Result<void> sample(const CLI::App& command, const SampleArguments& arguments) {
  if (auto ok = check(arguments.lit); !ok) return ok;
  CommandFiles files;
  add_files(files, arguments.sensors);
  add_files(files, arguments.lit);
  add_files(files, arguments.checkpoint);
  if (arguments.sensors.points.empty() && arguments.lit.path.empty())
    return input_error("there is nothing to write", arguments.checkpoint.path.string(),
                       "give --points FILE or -o lit.glb");
  if (auto ok = check(files); !ok) return ok;
  const auto sensors = read_sensors(arguments.sensors);
  if (!sensors) return tl::unexpected(sensors.error());
  warn_of_idle_sensors(command);
  const Result<SolverState> state = restore(arguments.checkpoint, files);
  if (!state) return tl::unexpected(state.error());
  return write_readings(arguments.sensors, *sensors, arguments.lit, *state);
}

}  // namespace

void add_sample(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<SampleArguments>();
  CLI::App& command = *cli.add_subcommand("sample", "irradiance at sensors of a solved scene");
  add_checkpoint_arguments(command, arguments->checkpoint);
  add_sensor_arguments(command, arguments->sensors);
  add_lit_arguments(command, arguments->lit);
  add_threads(command, arguments->threads);
  command.callback([arguments, &command, &status] {
    set_thread_count(arguments->threads);
    const Result<void> done = sample(command, *arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
