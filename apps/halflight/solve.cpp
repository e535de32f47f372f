// halflight solve: the main job, light a scene.
#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "command_files.h"
#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/io/atomic_file.h"
#include "halflight/output/read_light.h"
#include "halflight/output/report.h"
#include "halflight/scene/scene_digest.h"
#include "halflight/solve/checkpoint.h"
#include "halflight/solve/memory.h"
#include "halflight/solve/mix.h"
#include "interrupt.h"
#include "lit_output.h"
#include "scene_arguments.h"
#include "sensor_arguments.h"
#include "solve_arguments.h"
#include "solve_run.h"

namespace halflight::app {
namespace {

struct Outputs {
  LitArguments lit;
  SensorArguments sensors;
  std::filesystem::path report;
  std::filesystem::path checkpoint;
  bool resume = false;
  std::optional<std::string> groups;  // --light-groups; empty text: one for each name
};

struct SolveCommand {
  SceneArguments scene;
  SolveArguments solve;
  Outputs outputs;
};

void warn_without_output(const Outputs& outputs) {
  if (outputs.lit.path.empty() && outputs.sensors.points.empty() && outputs.report.empty() &&
      outputs.checkpoint.empty())
    warn("nothing will be written (add -o lit.glb, --points, --report or --checkpoint)");
}

// A checkpoint that is gone on from is written to again.
Result<void> check_files(const SolveCommand& command) {
  CommandFiles files;
  add_files(files, command.outputs.lit);
  add_files(files, command.outputs.sensors);
  files.writes("--report", command.outputs.report);
  files.writes("--checkpoint", command.outputs.checkpoint);
  add_files(files, command.solve);
  files.reads_scene(command.scene.path);
  return check(files);
}

// The light of each is kept, 24 bytes an element, and found by sweeps of its own.
constexpr std::size_t kMostLightGroups = 256;

Result<std::vector<LightGroup>> asked_groups(const Scene& scene, const std::string& together) {
  auto groups = find_light_groups(scene, together);
  if (groups && groups->size() > kMostLightGroups)
    return input_error(
        fmt::format("there are {} groups of lights, and at most {} can be kept apart",
                    groups->size(), kMostLightGroups),
        "--light-groups", "put several together, as \"ceiling=LampA,LampB\"");
  return groups;
}

// A resumed solve takes its groups from the checkpoint; others may not be asked for.
Result<void> check_groups(const Outputs& outputs, const SolverState& state) {
  std::vector<LightGroup> asked;
  if (outputs.groups) {
    const World& world = state.grouped.world ? *state.grouped.world : *state.world;
    auto groups = asked_groups(world.scene, *outputs.groups);
    if (!groups) return tl::unexpected(groups.error());
    asked = std::move(*groups);
  }
  const auto& there = state.grouped.groups;
  const auto same = [](const LightGroup& a, const LightGroup& b) {
    return a.name == b.name && a.materials == b.materials && a.lights == b.lights && a.sky == b.sky;
  };
  if (std::equal(there.begin(), there.end(), asked.begin(), asked.end(), same)) return {};
  return input_error("the checkpoint is of another solve: it has other light groups",
                     outputs.checkpoint.string(), "give the same --light-groups");
}

// A file that is as large as the limit cannot even be read.
Result<void> check_file_size(const std::filesystem::path& path, std::size_t memory) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(path, unknown);
  if (memory == 0 || unknown || bytes < memory) return {};
  return input_error(fmt::format("--memory {} MiB leaves no room to read this file", memory >> 20),
                     path.string(), fmt::format("give more than {} MiB", (bytes >> 20) + 1));
}

// The state to begin with: fresh, or that of the checkpoint.
Result<SolverState> begin(const Outputs& outputs, const std::shared_ptr<const World>& world,
                          const SolveOrigin& origin, Beginning beginning) {
  const auto fresh = [&]() -> Result<SolverState> {
    auto state = begin_solve(world, origin.options, beginning,
                             least_memory(outputs.lit, most_vertices_of_input(*world)));
    if (!state || !outputs.groups) return state;
    auto groups = asked_groups(world->scene, *outputs.groups);
    if (!groups) return tl::unexpected(groups.error());
    set_groups(*state, std::move(*groups));
    return state;
  };
  if (!outputs.resume) return fresh();
  std::error_code ignored;
  if (!std::filesystem::exists(outputs.checkpoint, ignored)) {
    warn(outputs.checkpoint.string() + " does not exist yet: solving from the beginning");
    return fresh();
  }
  const auto checkpoint = Checkpoint::open(outputs.checkpoint);
  if (!checkpoint) return tl::unexpected(checkpoint.error());
  if (auto same = checkpoint->check(origin); !same) return tl::unexpected(same.error());
  auto state = checkpoint->restore(world);
  if (!state) return state;
  if (auto same = check_groups(outputs, *state); !same) return tl::unexpected(same.error());
  return state;
}

// Keeps the last iteration that was not cut short: going on from there gives what would have come
// without the interruption.
class Saver {
 public:
  Saver(const Outputs& outputs, const SolveOrigin& origin, Report& report) : report_(report) {
    if (!outputs.checkpoint.empty()) keeper_.emplace(outputs.checkpoint, origin);
  }
  // A place that cannot be written to is told at once. A solution that is there already stays until
  // there is another.
  Result<void> begin(const SolverState& state) {
    if (keeper_ && state.history.empty() && is_checkpoint(keeper_->path())) return {};
    return save(&CheckpointKeeper::save, state);
  }
  void after_iteration(const SolverState& state, const Progress& progress) {
    cut_short_ = progress.cancelled();
    if (cut_short_) return;
    if (auto saved = save(&CheckpointKeeper::save_if_due, state); !saved)
      warn(saved.error().line());
  }
  Result<void> end(const SolverState& state) {
    return cut_short_ ? Result<void>() : save(&CheckpointKeeper::save, state);
  }

 private:
  Result<void> save(Result<void> (CheckpointKeeper::*how)(const SolverState&),
                    const SolverState& state) {
    if (!keeper_) return {};
    const auto start = Report::Clock::now();
    auto saved = ((*keeper_).*how)(state);
    report_.end_phase("checkpoint", start);
    return saved;
  }

  Report& report_;
  std::optional<CheckpointKeeper> keeper_;
  bool cut_short_ = false;
};

Result<int> run(const CLI::App& sub, const SolveCommand& command) {
  Report report;
  const auto start = std::chrono::steady_clock::now();
  Result<SolvePlan> plan = resolve(command.solve);
  if (!plan) return tl::unexpected(plan.error());
  if (auto ok = check(command.outputs.lit); !ok) return tl::unexpected(ok.error());
  if (auto ok = check_file_size(command.scene.path, plan->options.memory); !ok)
    return tl::unexpected(ok.error());
  if (auto ok = check_files(command); !ok) return tl::unexpected(ok.error());
  const auto sensors = read_sensors(command.outputs.sensors);
  if (!sensors) return tl::unexpected(sensors.error());
  Result<Scene> scene = load(command.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  warn_without_output(command.outputs);
  warn_of_idle_sensors(sub);
  report.end_phase("load", start);

  auto phase = std::chrono::steady_clock::now();
  const auto world = make_world(std::move(*scene));
  report.end_phase("rays", phase);
  if (auto ok = complete(*plan, command.solve, *world); !ok) return tl::unexpected(ok.error());

  Progress progress(progress_listener(command.solve));
  const Interruptible interruptible(progress);
  const Deadline deadline(progress, command.solve, start);
  phase = std::chrono::steady_clock::now();
  SolveOrigin origin{source_of(command.scene), 0, resolved(plan->options, *world)};
  if (!command.outputs.checkpoint.empty()) origin.scene_digest = digest_of(world->scene);
  Result<SolverState> begun =
      begin(command.outputs, world, origin, beginning_of(origin.options, deadline));
  if (!begun) return tl::unexpected(begun.error());
  SolverState& state = *begun;
  report.end_phase("hierarchy", phase);
  Saver saver(command.outputs, origin, report);
  if (auto saved = saver.begin(state); !saved) return tl::unexpected(saved.error());
  phase = std::chrono::steady_clock::now();
  const auto after_iteration = [&](const SolverState&) {
    if (state.history.size() == 1) balance(state, progress);
    saver.after_iteration(state, progress);
  };
  SolveOutcome outcome = run_to_goal(state, plan->goals, deadline, progress,
                                     !command.outputs.report.empty(), after_iteration);
  report.end_phase("solve", phase);
  // Taking the light apart undoes the balance of the groups that refinement goes on with.
  Result<void> written;
  const bool complete = state.done() && !progress.cancelled();
  if (!complete) written = saver.end(state);
  if (!state.grouped.groups.empty() && !state.grouped.separated()) {
    phase = std::chrono::steady_clock::now();
    separate_groups(state, plan->goals, progress, outcome);
    report.end_phase("light groups", phase);
  }
  if (complete) written = saver.end(state);
  if (state.options.memory > 0) drop_links(state);

  if (!sensors->empty()) {
    phase = std::chrono::steady_clock::now();
    also(written, write_irradiance(command.outputs.sensors, state, *sensors));
    report.end_phase("sensors", phase);
  }
  if (!command.outputs.lit.path.empty())
    also(written, write_lit(command.outputs.lit, state, report, progress));
  // Cancelled, iterations and the mesh end early: what is written is valid, and coarser.
  const int status = interruptible.interrupted()                 ? kInterrupted
                     : progress.cancelled() || !outcome.goal_met ? kBudgetEnded
                                                                 : kGoalMet;
  report.set_memory_limit(state.options.memory);
  if (outcome.error) report.set_estimated_error(*outcome.error);
  if (!command.outputs.report.empty())
    also(written, write_text_atomically(command.outputs.report, report.json(state)));
  if (!written) return tl::unexpected(written.error());
  return status;
}

}  // namespace

void add_solve(CLI::App& cli, int& status) {
  auto command = std::make_shared<SolveCommand>();
  CLI::App& sub = *cli.add_subcommand("solve", "light a scene");
  add_scene_arguments(sub, command->scene);
  add_solve_arguments(sub, command->solve);
  add_lit_arguments(sub, command->outputs.lit);
  add_sensor_arguments(sub, command->outputs.sensors);
  sub.add_option("--report", command->outputs.report, "what was done, JSON")
      ->check(file_name())
      ->type_name("FILE");
  CLI::Option* checkpoint =
      sub.add_option("--checkpoint", command->outputs.checkpoint,
                     "keep the solution here, to go on with --resume, for sample and for render")
          ->check(file_name())
          ->type_name("FILE");
  sub.add_option("--light-groups", command->outputs.groups,
                 "take the light apart by who sends it, for mix: each material, light and the sky "
                 "by name, or several together as \"ceiling=LampA,LampB;desk=LampC\"; at most 256")
      ->expected(0, 1)
      ->type_name("GROUPS");
  sub.add_flag("--resume", command->outputs.resume, "go on from the checkpoint")->needs(checkpoint);
  sub.callback([command, &sub, &status] {
    set_thread_count(command->solve.threads);
    const Result<int> done = run(sub, *command);
    status = done ? *done : fail(done.error());
  });
}

}  // namespace halflight::app
