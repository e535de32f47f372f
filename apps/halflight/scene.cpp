// halflight scene NAME: writes a built-in scene.
#include <cstdio>
#include <memory>

#include "commands.h"
#include "halflight/io/write_gltf.h"
#include "halflight/scene/procedural/catalogue.h"

namespace halflight::app {
namespace {

struct Request {
  Recipe recipe;
  std::string output;
};

int write(const Request& request) {
  const Result<void> written = write_scene_glb(request.output, request.recipe.build());
  if (!written) return fail(written.error());
  std::fprintf(stderr, "halflight: wrote %s\n", request.output.c_str());
  return kGoalMet;
}

void add_recipe(CLI::App& scene, Recipe recipe, int& status) {
  const auto request = std::make_shared<Request>(Request{std::move(recipe), {}});
  request->output = request->recipe.name + ".glb";
  CLI::App* command = scene.add_subcommand(request->recipe.name, request->recipe.summary);
  command->add_option("-o,--output", request->output, "GLB file to write")->capture_default_str();
  for (const Knob& knob : request->recipe.knobs) {
    const auto add = [&](auto* value) {
      command->add_option("--" + knob.name, *value, knob.meaning)
          ->check(CLI::Range(knob.least, knob.most))
          ->capture_default_str();
    };
    std::visit(add, knob.value);
  }
  command->callback([request, &status] { status = write(*request); });
}

void list_recipes() {
  for (const Recipe& recipe : scene_recipes())
    std::printf("%-16s %s\n", recipe.name.c_str(), recipe.summary.c_str());
}

}  // namespace

void add_scene(CLI::App& cli, int& status) {
  CLI::App* scene = cli.add_subcommand("scene", "Write a built-in scene as GLB");
  scene->require_subcommand(1);
  scene->add_subcommand("list", "tell the names of the scenes, one a line")->callback(list_recipes);
  for (Recipe& recipe : scene_recipes()) add_recipe(*scene, std::move(recipe), status);
}

}  // namespace halflight::app
