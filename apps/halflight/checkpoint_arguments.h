// A solution that was stored: the positional CHECKPOINT and --scene.
#pragma once

#include <filesystem>

#include <CLI/App.hpp>

#include "command_files.h"
#include "halflight/base/result.h"
#include "halflight/solve/checkpoint.h"

namespace halflight::app {

struct CheckpointArguments {
  std::filesystem::path path;
  std::filesystem::path scene;  // empty: where it was
};

// `arguments` must live until the command has run.
void add_checkpoint_arguments(CLI::App& command, CheckpointArguments& arguments);
// --scene alone.
CLI::Option* add_scene_of_checkpoint(CLI::App& command, std::filesystem::path& scene);

// The solution over a world made from the checkpoint's scene, with light groups taken apart.
Result<SolverState> restore(const Checkpoint& checkpoint,
                            const std::shared_ptr<const World>& world);
// The solution over its scene, warnings of which are printed. An error where one of the files that
// are written would replace the scene.
Result<SolverState> restore(const CheckpointArguments& arguments, CommandFiles files);
void add_files(CommandFiles& files, const CheckpointArguments& arguments);
// The scene is known once the checkpoint is read.
Result<void> check_with_scene(CommandFiles files, const Checkpoint& checkpoint,
                              const std::filesystem::path& instead);

}  // namespace halflight::app
