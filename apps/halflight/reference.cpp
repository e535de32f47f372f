// halflight reference SCENE --points FILE --spp N: path-traced irradiance at sensors.
#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "command_files.h"
#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/io/sensors.h"
#include "halflight/rays/reference_sensors.h"
#include "number_checks.h"
#include "scene_arguments.h"
#include "terminal_progress.h"
#include "visibility_arguments.h"

namespace halflight::app {
namespace {

struct ReferenceArguments {
  SceneArguments scene;
  std::filesystem::path points;
  std::filesystem::path points_out;
  std::uint32_t samples = 0;
  std::uint64_t seed = 0;
  int threads = 0;
  VisibilityArguments visibility;
};

// Root mean square over the channels.
float one_number(const Rgb& standard_error) {
  return std::sqrt(glm::dot(standard_error, standard_error) / 3.f);
}

struct TimedEstimates {
  std::vector<IrradianceEstimate> at_sensors;
  double seconds = 0.0;
};

// Against exact rays on the same samples: where bounces are exact the noise is much the same and
// cancels.
void report_bias(const TimedEstimates& tried, const TimedEstimates& reference) {
  const auto& estimates = tried.at_sensors;
  const auto& exact = reference.at_sensors;
  double sum = 0.0, exact_sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const auto mean = static_cast<double>(average(estimates[i].mean));
    const auto truth = static_cast<double>(average(exact[i].mean));
    sum += mean;
    exact_sum += truth;
    squares += (mean - truth) * (mean - truth);
  }
  if (!(exact_sum > 0.0)) return;
  const auto count = static_cast<double>(exact.size());
  std::fputs(fmt::format("halflight: against exact rays: mean irradiance {:+.2f} %, RMS "
                         "difference {:.2f} % of the mean, {:.2f} times the time ({:.2f} s)\n",
                         100.0 * (sum / exact_sum - 1.0),
                         100.0 * std::sqrt(squares / count) / (exact_sum / count),
                         tried.seconds / reference.seconds, tried.seconds)
                 .c_str(),
             stderr);
}

Result<void> reference(const CLI::App& command, const ReferenceArguments& arguments) {
  if (auto ok = check_for_paths(arguments.visibility); !ok) return ok;
  CommandFiles files;
  files.reads("the sensors", arguments.points);
  files.reads_scene(arguments.scene.path);
  files.writes("--points-out", arguments.points_out);
  if (auto ok = check(files); !ok) return ok;
  warn_of_idle_visibility(command, arguments.visibility);
  const auto sensors = read_sensors(arguments.points);
  if (!sensors) return tl::unexpected(sensors.error());
  Result<Scene> scene = load(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  const World world(std::move(*scene));
  const auto visibility = path_visibility(arguments.visibility, world);
  if (!visibility) return tl::unexpected(visibility.error());

  std::vector<WorldSensor> in_world;
  for (const Sensor& sensor : *sensors) in_world.push_back(to_world(world.scene.to_world, sensor));
  const Progress progress(terminal_progress());
  const auto trace = [&](const PathRays* rays) {
    const auto start = std::chrono::steady_clock::now();
    TimedEstimates estimates{reference_irradiance(PathTracer(world, rays), in_world,
                                                  arguments.samples, arguments.seed, progress)};
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    estimates.seconds = time.count();
    return estimates;
  };
  const TimedEstimates estimates = trace(*visibility ? &(*visibility)->rays() : nullptr);
  if (*visibility) report_bias(estimates, trace(nullptr));
  std::vector<Rgb> means;
  std::vector<float> errors;
  for (const IrradianceEstimate& e : estimates.at_sensors) {
    means.push_back(e.mean);
    errors.push_back(one_number(e.standard_error));
  }
  return write_sensor_table(arguments.points_out, sensor_table(*sensors, means, errors));
}

}  // namespace

void add_reference(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<ReferenceArguments>();
  CLI::App& command = *cli.add_subcommand("reference", "path-traced irradiance at sensors");
  add_scene_arguments(command, arguments->scene);
  command
      .add_option("--points", arguments->points,
                  "sensors, one x y z nx ny nz a line, in the scene's own coordinates")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--points-out", arguments->points_out,
                  "where to write the sensors with Er Eg Eb and their standard error (RMS of the "
                  "channels); default: standard output")
      ->check(file_name())
      ->type_name("FILE");
  command.add_option("--spp", arguments->samples, "paths per sensor")
      ->type_name("N")
      ->check(from_to(2u, 1u << 30).description("2 to 2^30"))
      ->required();
  add_visibility_arguments(command, arguments->visibility, "exact");
  add_bounce_argument(command, arguments->visibility);
  add_seed(command, arguments->seed);
  add_threads(command, arguments->threads);
  command.callback([arguments, &command, &status] {
    set_thread_count(arguments->threads);
    const Result<void> done = reference(command, *arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
