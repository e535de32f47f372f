#include "checkpoint_arguments.h"

#include "halflight/solve/mix.h"
#include "scene_arguments.h"

namespace halflight::app {

CLI::Option* add_scene_of_checkpoint(CLI::App& command, std::filesystem::path& scene) {
  return command.add_option("--scene", scene, "where the checkpoint's scene is, if it was moved")
      ->type_name("FILE");
}

void add_checkpoint_arguments(CLI::App& command, CheckpointArguments& arguments) {
  command.add_option("CHECKPOINT", arguments.path, "what solve --checkpoint has written")
      ->required();
  add_scene_of_checkpoint(command, arguments.scene);
}

Result<SolverState> restore(const Checkpoint& checkpoint,
                            const std::shared_ptr<const World>& world) {
  Result<SolverState> state = checkpoint.restore(world);
  if (state && state->history.empty())
    return input_error("the checkpoint holds no light yet: its solve ended too early",
                       checkpoint.path().string(), "go on with solve --checkpoint FILE --resume");
  if (state && !state->grouped.groups.empty() && !state->grouped.separated()) separate(*state, {});
  return state;
}

void add_files(CommandFiles& files, const CheckpointArguments& arguments) {
  files.reads("the checkpoint", arguments.path);
}

Result<void> check_with_scene(CommandFiles files, const Checkpoint& checkpoint,
                              const std::filesystem::path& instead) {
  files.reads_scene(instead.empty() ? checkpoint.origin().scene.path : instead);
  return check(files);
}

Result<SolverState> restore(const CheckpointArguments& arguments, CommandFiles files) {
  const auto checkpoint = Checkpoint::open(arguments.path);
  if (!checkpoint) return tl::unexpected(checkpoint.error());
  if (auto ok = check_with_scene(std::move(files), *checkpoint, arguments.scene); !ok)
    return tl::unexpected(ok.error());
  Result<Scene> scene = checkpoint->load_scene(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  print_warnings(*scene);
  return restore(*checkpoint, make_world(std::move(*scene)));
}

}  // namespace halflight::app
