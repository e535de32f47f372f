#include "scene_arguments.h"

#include <cmath>
#include <cstdio>
#include <map>

#include "halflight/scene/radiance.h"

namespace halflight::app {
namespace {

using Units = std::map<std::string, double>;
const Units& metres_per_unit() {
  static const Units units = {
      {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
  return units;
}

void set_unit(const std::string& name, LoadOptions& load) {
  const auto unit = metres_per_unit().find(name);
  if (unit == metres_per_unit().end())
    throw CLI::ValidationError("--unit", "'" + name + "' is none of m, cm, mm, in, ft");
  load.metres_per_unit = unit->second;
}

void set_up_axis(const std::string& name, LoadOptions& load) {
  if (name != "y" && name != "z")
    throw CLI::ValidationError("--up", "'" + name + "' is neither y nor z");
  load.up = name == "z" ? UpAxis::z : UpAxis::y;
}

std::string check_radiance(const std::string& text) {
  double value = 0.0;
  const bool valid =
      CLI::detail::lexical_cast(text, value) && value >= 0.0 && value <= double{kMaxRadiance};
  return valid ? std::string() : "'" + text + "' is not a radiance: three numbers >= 0, as 1,1,1";
}

}  // namespace

void add_scene_arguments(CLI::App& command, SceneArguments& arguments,
                         const std::string& positional) {
  command.add_option(positional, arguments.path, "scene file: .glb, .gltf or .obj")->required();
  LoadOptions& load = arguments.load;
  command
      .add_option_function<std::string>(
          "--unit", [&load](const std::string& name) { set_unit(name, load); },
          "unit of the scene's lengths")
      ->type_name("m|cm|mm|in|ft")
      ->default_str("m");
  command
      .add_option_function<std::string>(
          "--up", [&load](const std::string& name) { set_up_axis(name, load); },
          "axis of the scene that points up")
      ->type_name("y|z")
      ->default_str("y");
  command.add_option("--sky", arguments.sky, "constant radiance of the sky, W/m2/sr")
      ->delimiter(',')
      ->check(check_radiance)
      ->type_name("R,G,B")
      ->default_str("0,0,0");
}

Result<Scene> load(const SceneArguments& arguments) {
  Result<Scene> scene = load_scene(arguments.path, arguments.load);
  if (scene) scene->sky = source_of(arguments).sky;
  return scene;
}

SceneSource source_of(const SceneArguments& arguments) {
  return {arguments.path, arguments.load, {arguments.sky[0], arguments.sky[1], arguments.sky[2]}};
}

void print_warnings(const Scene& scene) {
  for (const std::string& warning : scene.warnings)
    std::fprintf(stderr, "halflight: warning: %s\n", warning.c_str());
}

}  // namespace halflight::app
