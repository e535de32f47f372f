// halflight render SCENE|CHECKPOINT: a picture from a camera, of the solved light or path-traced.
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "checkpoint_arguments.h"
#include "command_files.h"
#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/io/image_write.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/solution_image.h"
#include "halflight/rays/automatic_view.h"
#include "halflight/rays/path_traced_image.h"
#include "halflight/solve/memory.h"
#include "idle_options.h"
#include "lit_output.h"
#include "number_checks.h"
#include "scene_arguments.h"
#include "solve_arguments.h"
#include "solve_run.h"
#include "view_arguments.h"

namespace halflight::app {
namespace {

struct RenderArguments {
  SceneArguments scene;
  std::filesystem::path scene_of_checkpoint;
  SolveArguments solve;
  ViewArguments view;
  std::uint32_t path_trace = 0;  // paths per pixel; 0: show the solved light
  int samples_per_pixel = 4;
  std::filesystem::path visibility_output;
  std::uint32_t visibility_samples = 64;
  std::uint64_t seed = 0;
};

Result<void> check(const RenderArguments& arguments) {
  if (auto ok = check(arguments.view); !ok) return ok;
  if (const auto plan = resolve(arguments.solve); !plan) return tl::unexpected(plan.error());
  if (arguments.path_trace > 0)
    if (auto ok = check_for_paths(arguments.solve.visibility); !ok) return ok;
  if (arguments.visibility_output.empty()) return {};
  return check_image_name(arguments.visibility_output);
}

CommandFiles files_of(const RenderArguments& arguments, bool checkpoint) {
  CommandFiles files;
  add_files(files, arguments.view);
  files.writes("--visibility-mask", arguments.visibility_output);
  add_files(files, arguments.solve);
  if (checkpoint)
    files.reads("the checkpoint", arguments.scene.path);
  else
    files.reads_scene(arguments.scene.path);
  return files;
}

// Scripts may take pictures of solved and of traced light by the same options.
void warn_of_idle_options(const CLI::App& command, const RenderArguments& arguments) {
  if (arguments.path_trace == 0) {
    warn_of_idle(command, {"--bounces"}, "without --path-trace");
  } else {
    warn_of_idle(command,
                 {"--error", "--time", "--memory", "--links", "--hierarchy", "--intra-cluster",
                  "--importance", "--feature-sizes", "--samples"},
                 "with --path-trace");
    warn_of_idle_visibility(command, arguments.solve.visibility);
  }
  if (arguments.view.output.extension() == ".exr")
    warn_of_idle(command, {"--exposure", "--tone-map"}, "on .exr, which holds radiance");
}

// The scene of a checkpoint and the light in it are what they are.
Result<void> check_for_checkpoint(const CLI::App& command, const RenderArguments& arguments) {
  if (!is_checkpoint(arguments.scene.path)) {
    if (arguments.scene_of_checkpoint.empty()) return {};
    return input_error("--scene goes with a checkpoint", arguments.scene.path.string(),
                       "leave it out");
  }
  std::vector<const char*> fixed{"--unit", "--up", "--sky"};
  if (arguments.path_trace == 0)
    fixed.insert(fixed.end(),
                 {"--visibility", "--feature-size", "--error", "--time", "--memory", "--links",
                  "--hierarchy", "--intra-cluster", "--importance", "--feature-sizes"});
  for (const char* option : fixed)
    if (command.get_option(option)->count() > 0)
      return input_error(fmt::format("{} is already settled by the checkpoint", option),
                         arguments.scene.path.string(), "leave it out, or solve again with it");
  return {};
}

Result<SolverState> solve(const RenderArguments& arguments,
                          const std::shared_ptr<const World>& world) {
  Result<SolvePlan> plan = resolve(arguments.solve);
  if (!plan) return tl::unexpected(plan.error());
  if (auto ok = complete(*plan, arguments.solve, *world); !ok) return tl::unexpected(ok.error());
  // A deadline ends the refinement and not the picture.
  Progress solving(progress_listener(arguments.solve));
  const Deadline deadline(solving, arguments.solve, Deadline::Clock::now());
  Result<SolverState> begun =
      begin_solve(world, plan->options, beginning_of(plan->options, deadline));
  if (!begun) return begun;
  SolverState& state = *begun;
  run_to_goal(state, plan->goals, deadline, solving, false);
  if (state.options.memory > 0) drop_links(state);
  return begun;
}

Result<Image> solved_image(const RenderArguments& arguments,
                           const std::shared_ptr<const World>& world,
                           const std::optional<Checkpoint>& checkpoint, const View& view,
                           const Progress& progress) {
  const Result<SolverState> solved =
      checkpoint ? restore(*checkpoint, world) : solve(arguments, world);
  if (!solved) return tl::unexpected(solved.error());
  const SolverState& state = *solved;
  return solution_image(state, lit_mesh_options(state),
                        CameraRays(view.camera, view.width, view.height), view.width, view.height,
                        arguments.samples_per_pixel, progress);
}

Result<Image> path_traced(const RenderArguments& arguments, const World& world, const View& view,
                          const Progress& progress) {
  const auto visibility = path_visibility(arguments.solve.visibility, world);
  if (!visibility) return tl::unexpected(visibility.error());
  const PathTracer tracer(world, *visibility ? &(*visibility)->rays() : nullptr);
  return path_traced_image(tracer, CameraRays(view.camera, view.width, view.height), view.width,
                           view.height, arguments.path_trace, arguments.seed, progress);
}

Result<void> render(const CLI::App& command, const RenderArguments& arguments) {
  if (auto ok = check(arguments); !ok) return ok;
  std::optional<Checkpoint> checkpoint;
  const bool solved = is_checkpoint(arguments.scene.path);
  CommandFiles files = files_of(arguments, solved);
  if (auto ok = check(files); !ok) return ok;
  warn_of_idle_options(command, arguments);
  if (solved) {
    auto opened = Checkpoint::open(arguments.scene.path);
    if (!opened) return tl::unexpected(opened.error());
    checkpoint = std::move(*opened);
    if (auto ok = check_with_scene(std::move(files), *checkpoint, arguments.scene_of_checkpoint);
        !ok)
      return ok;
  }
  Result<Scene> scene =
      checkpoint ? checkpoint->load_scene(arguments.scene_of_checkpoint) : load(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  const auto world = make_world(std::move(*scene));
  const PathTracer tracer(*world);
  const Result<View> view = choose_view(arguments.view, world->scene, world->geometry,
                                        [&] { return automatic_view(tracer, arguments.seed); });
  if (!view) return tl::unexpected(view.error());

  const Progress progress(progress_listener(arguments.solve));
  const Result<Image> picture = arguments.path_trace > 0
                                    ? path_traced(arguments, *world, *view, progress)
                                    : solved_image(arguments, world, checkpoint, *view, progress);
  if (!picture) return tl::unexpected(picture.error());
  Result<void> written = write_picture(arguments.view, *picture);
  if (arguments.visibility_output.empty()) return written;
  const CameraRays camera(view->camera, view->width, view->height);
  const Image visibility = visibility_image(tracer, camera, view->width, view->height,
                                            arguments.visibility_samples, arguments.seed, progress);
  also(written, write_image(arguments.visibility_output, visibility));
  return written;
}

}  // namespace

void add_render(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App& command = *cli.add_subcommand("render", "picture of a scene from a camera");
  add_scene_arguments(command, arguments->scene, "SCENE|CHECKPOINT");
  add_scene_of_checkpoint(command, arguments->scene_of_checkpoint);
  add_view_arguments(command, arguments->view);
  add_solve_arguments(command, arguments->solve);
  command
      .add_option("--path-trace", arguments->path_trace, "trace this many paths per pixel instead")
      ->type_name("SPP")
      ->check(from_to(1u, 1u << 24));
  add_bounce_argument(command, arguments->solve.visibility);
  command
      .add_option("--samples", arguments->samples_per_pixel,
                  "camera rays per pixel of solved light")
      ->check(from_to(1, 1024).description("1 to 1024"))
      ->type_name("N")
      ->capture_default_str();
  CLI::Option* mask =
      command
          .add_option(
              "--visibility-mask", arguments->visibility_output,
              "also write the visible share of the direct light of each pixel: .exr or .png")
          ->check(file_name())
          ->type_name("FILE");
  command.add_option("--mask-samples", arguments->visibility_samples, "light samples per pixel")
      ->type_name("N")
      ->needs(mask)
      ->check(from_to(1u, 1u << 24))
      ->capture_default_str();
  add_seed(command, arguments->seed);
  command.callback([arguments, &command, &status] {
    set_thread_count(arguments->solve.threads);
    Result<void> done = check_for_checkpoint(command, *arguments);
    if (done) done = render(command, *arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
