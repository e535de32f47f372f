// halflight inspect: what is in a scene and what is wrong with it.
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "halflight/base/one_line.h"
#include "halflight/scene/lint.h"
#include "halflight/scene/summary.h"
#include "inspect_hierarchy.h"
#include "scene_arguments.h"

namespace halflight::app {
namespace {

using nlohmann::json;

struct Inspection {
  Scene scene;
  Geometry geometry;
  SceneSummary summary;
  std::vector<Finding> findings;
};

Inspection inspect(Scene scene) {
  Inspection i{std::move(scene), {}, {}, {}};
  i.geometry = flatten(i.scene);
  i.summary = summarize(i.scene, i.geometry);
  i.findings = lint(i.scene, i.geometry, i.summary);
  return i;
}

std::string name_of(const Scene& scene, MaterialId id) {
  const std::string& name = scene.materials[id].name;
  return name.empty() ? fmt::format("material {}", id.value) : name;
}

const char* word(Light::Kind kind) {
  switch (kind) {
    case Light::Kind::point:
      return "point";
    case Light::Kind::spot:
      return "spot";
    case Light::Kind::directional:
      return "directional";
  }
  return "";
}

const char* word(Finding::Severity severity) {
  return severity == Finding::Severity::warning ? "warning" : "note";
}

json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

json emitters_json(const Inspection& i) {
  json emitters = json::array();
  for (const EmitterSummary& e : i.summary.emitters)
    emitters.push_back({{"material", name_of(i.scene, e.material)},
                        {"triangles", e.triangles},
                        {"area", e.area},
                        {"radiance", to_json(e.radiance)},
                        {"power", to_json(e.power)},
                        {"double_sided", i.scene.materials[e.material].double_sided}});
  return emitters;
}

json fixtures_json(const Geometry& g) {
  json lights = json::array(), cameras = json::array();
  for (const PunctualLight& light : g.lights)
    lights.push_back({{"kind", word(light.kind)},
                      {"position", to_json(light.position)},
                      {"direction", to_json(light.direction)},
                      {"intensity", to_json(light.intensity)}});
  for (const PlacedCamera& camera : g.cameras)
    cameras.push_back({{"name", camera.name},
                       {"position", to_json(camera.position)},
                       {"forward", to_json(camera.forward)},
                       {"up", to_json(camera.up)},
                       {"perspective", camera.perspective}});
  return {{"lights", lights}, {"cameras", cameras}};
}

json findings_json(const Inspection& i) {
  json findings = json::array();
  for (const Finding& f : i.findings)
    findings.push_back({{"severity", word(f.severity)},
                        {"code", f.code},
                        {"message", f.message},
                        {"remedy", f.remedy}});
  return findings;
}

json to_json(const Inspection& i) {
  const SceneSummary& s = i.summary;
  json all = fixtures_json(i.geometry);
  all["triangles"] = s.triangles;
  all["degenerate_triangles"] = s.degenerate_triangles;
  all["vertices"] = s.vertices;
  all["nodes"] = i.scene.nodes.size();
  all["meshes"] = i.scene.meshes.size();
  all["instances"] = s.instances;
  all["materials"] = i.scene.materials.size();
  all["textures"] = i.scene.textures.size();
  all["texels"] = s.texels;
  all["area"] = s.area;
  all["mean_reflectance"] = to_json(s.reflectance);
  all["emitters"] = emitters_json(i);
  all["emitted_power"] = to_json(s.emitted_power);
  all["sky"] = to_json(i.scene.sky);
  all["bounds"] = json::object();
  if (!s.bounds.empty())
    all["bounds"] = {{"lower", to_json(s.bounds.lower)}, {"upper", to_json(s.bounds.upper)}};
  all["diagonal"] = s.bounds.diagonal();
  all["findings"] = findings_json(i);
  all["warnings"] = i.scene.warnings;
  return all;
}

void print_emitters(const Inspection& i) {
  constexpr std::size_t kShown = 8, kName = 60;
  const auto& emitters = i.summary.emitters;
  fmt::print("emitters   {}, {:.4g} {:.4g} {:.4g} W (or lm) in all\n", emitters.size(),
             i.summary.emitted_power.r, i.summary.emitted_power.g, i.summary.emitted_power.b);
  for (std::size_t k = 0; k < std::min(kShown, emitters.size()); ++k) {
    const EmitterSummary& e = emitters[k];
    fmt::print("  {:<24} {:>7} triangles {:>9.4g} m2 {:>9.4g} W{}\n",
               one_line(name_of(i.scene, e.material), kName), e.triangles, e.area,
               luminance(e.power),
               i.scene.materials[e.material].double_sided ? ", both sides" : "");
  }
  if (emitters.size() > kShown) fmt::print("  and {} more\n", emitters.size() - kShown);
}

void print(const std::string& path, const Inspection& i) {
  const SceneSummary& s = i.summary;
  const Vec3 size = s.bounds.extent();
  fmt::print("{}\n", path);
  fmt::print("size       {:.4g} x {:.4g} x {:.4g} m, {:.4g} m2 of surface\n", size.x, size.y,
             size.z, s.area);
  fmt::print("triangles  {} in {} meshes, {} instances\n", s.triangles, i.scene.meshes.size(),
             s.instances);
  fmt::print("materials  {}, mean reflectance {:.2f}; {} textures, {:.1f} M texels\n",
             i.scene.materials.size(), luminance(s.reflectance), i.scene.textures.size(),
             1e-6 * static_cast<double>(s.texels));
  print_emitters(i);
  fmt::print("lights     {}\n", i.geometry.lights.size());
  for (const PunctualLight& light : i.geometry.lights)
    fmt::print("  {:<12} {:.4g} {:.4g} {:.4g} {}\n", word(light.kind), light.intensity.r,
               light.intensity.g, light.intensity.b,
               light.kind == Light::Kind::directional ? "lux" : "cd");
  fmt::print("cameras    {}\n", i.geometry.cameras.size());
  for (const Finding& f : i.findings)
    fmt::print("{}: {}{}\n", word(f.severity), f.message,
               f.remedy.empty() ? "" : " (" + f.remedy + ")");
  for (const std::string& warning : i.scene.warnings) fmt::print("warning: {}\n", warning);
}

struct Arguments {
  SceneArguments scene;
  std::string hierarchy;  // a name, "all", or empty
  bool as_json = false;
};

int run(const Arguments& arguments) {
  Result<Scene> scene = load(arguments.scene);
  if (!scene) return fail(scene.error());
  std::vector<InspectedHierarchy> hierarchies;
  if (!arguments.hierarchy.empty()) hierarchies = inspect_hierarchies(*scene, arguments.hierarchy);
  const Inspection inspection = inspect(std::move(*scene));
  if (arguments.as_json) {
    json all = to_json(inspection);
    if (!hierarchies.empty()) all["hierarchies"] = hierarchies_json(hierarchies);
    fmt::print("{}\n", all.dump(1, ' ', false, json::error_handler_t::replace));
  } else {
    print(arguments.scene.path.string(), inspection);
    print_hierarchies(hierarchies);
  }
  return kGoalMet;
}

}  // namespace

void add_inspect(CLI::App& cli, int& status) {
  CLI::App* command = cli.add_subcommand("inspect", "what is in a scene and what is wrong with it");
  auto arguments = std::make_shared<Arguments>();
  add_scene_arguments(*command, arguments->scene);
  command
      ->add_option("--hierarchy", arguments->hierarchy,
                   "how well a builder's clusters serve this scene; all: every builder")
      ->check(CLI::IsMember(hierarchy_choices()).description(""))
      ->type_name("all|size-grid|kd-tree|goldsmith-salmon|agglomerative");
  command->add_flag("--json", arguments->as_json, "print all of it as JSON");
  command->callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace halflight::app
