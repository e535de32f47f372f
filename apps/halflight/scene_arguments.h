// The arguments that every sub-command which reads a scene shares: SCENE, --unit, --up, --sky.
#pragma once

#include <filesystem>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "halflight/base/result.h"
#include "halflight/io/load_scene.h"
#include "halflight/scene/scene.h"
#include "halflight/solve/checkpoint.h"

namespace halflight::app {

struct SceneArguments {
  std::filesystem::path path;
  LoadOptions load;
  std::array<float, 3> sky{0.f, 0.f, 0.f};
};

// Adds the positional SCENE and the options; `arguments` must live until the command has run.
void add_scene_arguments(CLI::App& command, SceneArguments& arguments,
                         const std::string& positional = "SCENE");

// Reads the scene and gives it the sky. Scene::warnings is left to the caller to show.
Result<Scene> load(const SceneArguments& arguments);

// What a checkpoint remembers of these arguments.
SceneSource source_of(const SceneArguments& arguments);

// Prints Scene::warnings to stderr, one line each.
void print_warnings(const Scene& scene);

}  // namespace halflight::app
