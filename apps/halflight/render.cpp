// halflight render SCENE --path-trace SPP: a picture from a camera.
#include <memory>

#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/io/image_write.h"
#include "halflight/rays/automatic_view.h"
#include "halflight/rays/path_traced_image.h"
#include "scene_arguments.h"
#include "terminal_progress.h"
#include "view_arguments.h"

namespace halflight::app {
namespace {

struct RenderArguments {
  SceneArguments scene;
  ViewArguments view;
  std::uint32_t samples_per_pixel = 0;
  std::filesystem::path visibility_output;
  std::uint32_t visibility_samples = 64;
  std::uint64_t seed = 0;
  int threads = 0;
};

Result<void> check(const RenderArguments& arguments) {
  if (auto ok = check(arguments.view); !ok) return ok;
  if (!arguments.visibility_output.empty()) return check_image_name(arguments.visibility_output);
  return {};
}

Result<void> render(const RenderArguments& arguments) {
  if (auto ok = check(arguments); !ok) return ok;
  Result<Scene> scene = load(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  const World world(std::move(*scene));
  const PathTracer tracer(world);
  const Result<View> view = choose_view(arguments.view, world.scene, world.geometry,
                                        [&] { return automatic_view(tracer, arguments.seed); });
  if (!view) return tl::unexpected(view.error());

  const CameraRays camera(view->camera, view->width, view->height);
  const Progress progress(terminal_progress());
  const Image picture = path_traced_image(tracer, camera, view->width, view->height,
                                          arguments.samples_per_pixel, arguments.seed, progress);
  if (auto written = write_picture(arguments.view, picture); !written) return written;
  if (arguments.visibility_output.empty()) return {};
  const Image visibility = visibility_image(tracer, camera, view->width, view->height,
                                            arguments.visibility_samples, arguments.seed, progress);
  return write_image(arguments.visibility_output, visibility);
}

}  // namespace

void add_render(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App& command = *cli.add_subcommand("render", "picture of a scene from a camera");
  add_scene_arguments(command, arguments->scene);
  add_view_arguments(command, arguments->view);
  command.add_option("--path-trace", arguments->samples_per_pixel, "paths per pixel")
      ->type_name("SPP")
      ->check(CLI::Range(1u, 1u << 24))
      ->required();
  command
      .add_option("--visibility", arguments->visibility_output,
                  "also write the visible share of the direct light of each pixel: .exr or .png")
      ->type_name("FILE");
  command
      .add_option("--visibility-samples", arguments->visibility_samples, "light samples per pixel")
      ->type_name("N")
      ->check(CLI::Range(1u, 1u << 24))
      ->capture_default_str();
  command.add_option("--seed", arguments->seed, "picks another set of samples")
      ->capture_default_str();
  command.add_option("--threads", arguments->threads, "0: all cores")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.callback([arguments, &status] {
    set_thread_count(arguments->threads);
    const Result<void> done = render(*arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
