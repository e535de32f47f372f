// halflight scene NAME: writes a built-in scene.
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "command_files.h"
#include "commands.h"
#include "halflight/io/atomic_file.h"
#include "halflight/io/write_gltf.h"
#include "halflight/scene/procedural/catalogue.h"
#include "number_checks.h"

namespace halflight::app {
namespace {

struct Request {
  Recipe recipe;
  std::string output;
};

int write(const Request& request) {
  if (auto ok = check_writable(request.output); !ok) return fail(ok.error());
  const Result<void> written = write_scene_glb(request.output, request.recipe.build());
  if (!written) return fail(written.error());
  std::fprintf(stderr, "halflight: wrote %s\n", request.output.c_str());
  return kGoalMet;
}

CLI::Validator range_of(const Knob& knob) {
  const auto whole = [](double bound) { return static_cast<int>(bound); };
  const bool counts = std::holds_alternative<int*>(knob.value);
  CLI::Validator range =
      counts ? from_to(whole(knob.least), whole(knob.most)) : from_to(knob.least, knob.most);
  return range.description(fmt::format("{:g} to {:g}", knob.least, knob.most));
}

void add_recipe(CLI::App& scene, Recipe recipe, int& status) {
  const auto request = std::make_shared<Request>(Request{std::move(recipe), {}});
  request->output = request->recipe.name + ".glb";
  CLI::App* command = scene.add_subcommand(request->recipe.name, request->recipe.summary);
  command->add_option("-o,--output", request->output, "GLB file to write")
      ->check(file_name())
      ->capture_default_str();
  for (const Knob& knob : request->recipe.knobs) {
    const auto add = [&](auto* value) {
      command->add_option("--" + knob.name, *value, knob.meaning)
          ->check(range_of(knob))
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
  CLI::App* scene = cli.add_subcommand("scene", "write a built-in scene");
  scene->require_subcommand(0, 1);
  scene->add_subcommand("list", "names of the scenes, one a line")->callback(list_recipes);
  for (Recipe& recipe : scene_recipes()) add_recipe(*scene, std::move(recipe), status);
  // What is no scene's name ends up here.
  const auto unknown = std::make_shared<std::string>();
  scene->add_option("name", *unknown)->group("");
  scene->callback([=, &status] {
    if (scene->get_subcommands().empty()) status = fail(find_recipe(*unknown).error());
  });
}

}  // namespace halflight::app
