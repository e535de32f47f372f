#include "halflight/output/report.h"

#include <ctime>

#include <nlohmann/json.hpp>

#include "halflight/base/memory.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

using nlohmann::json;

json rgb(const Rgb& c) { return {c.r, c.g, c.b}; }

json input(const SolverState& state) {
  const Geometry& g = state.world->geometry;
  std::size_t emitters = 0;
  for (const MaterialId m : g.materials) emitters += state.world->scene.materials[m].emits();
  return {{"triangles", g.triangles.size()},
          {"degenerate_triangles", g.degenerate_triangles},
          {"surfaces", state.surfaces->surfaces.size()},
          {"emitting_triangles", emitters},
          {"punctual_lights", g.lights.size()},
          {"bounds", {rgb(g.bounds.lower), rgb(g.bounds.upper)}}};
}

json settings(const SolverState& state) {
  const SolveOptions& o = state.options;
  return {{"feature_size", o.feature_size},
          {"feature_size_rules", o.feature_size_rules.size()},
          {"feature_size_in_pixels", o.pixels ? json(o.pixels->pixels) : json()},
          {"importance_of_a_view", o.importance.has_value()},
          {"most_links", o.most_links},
          {"error", o.error},
          {"links", o.links == LinkMaker::refined ? "refined" : "sampled"},
          {"visibility", name_of(state.visibility->mode())},
          {"hierarchy", name_of(o.hierarchy)},
          {"intra_cluster", o.intra_cluster},
          {"levels", o.levels},
          {"sky", rgb(state.world->scene.sky)},
          {"threads", thread_count()},
          {"instruction_set", RayScene::instruction_set()}};
}

json history(const SolverState& state) {
  json iterations = json::array();
  for (const IterationRecord& i : state.history)
    iterations.push_back({{"stage", name_of(i.stage)},
                          {"irradiance_threshold", i.irradiance_threshold},
                          {"links_refined", i.refined},
                          {"pairs", i.pairs},
                          {"links", i.links},
                          {"elements", i.elements},
                          {"rays", i.rays},
                          {"sweeps", i.sweeps},
                          {"predicted_seconds", i.predicted_seconds},
                          {"seconds", i.seconds()},
                          {"refine_seconds", i.refine_seconds},
                          {"sweep_seconds", i.sweep_seconds}});
  return iterations;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

void Report::end_phase(const std::string& name, Clock::time_point start) {
  peaks_.emplace_back(name, peak_resident_bytes());
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  for (auto& [known, sum] : phases_)
    if (known == name) {
      sum += seconds;
      return;
    }
  phases_.emplace_back(name, seconds);
}

void Report::set_lit_mesh(const LitMesh& mesh, float exposure) {
  has_mesh_ = true;
  mesh_vertices_ = mesh.vertices;
  mesh_triangles_ = mesh.triangles;
  mesh_readings_ = mesh.readings;
  exposure_ = exposure;
}

void Report::set_lightmap(const Lightmap& map) {
  lightmap_ = LightmapNumbers{.size = map.layout.size,
                              .charts = map.charts.charts.size(),
                              .read = map.read,
                              .covered = map.covered,
                              .texels_per_metre = map.layout.texels_per_metre,
                              .filled = map.layout.filled,
                              .seams_as_read = map.seam_difference_as_read,
                              .seams = map.seam_difference};
}

std::string Report::json(const SolverState& state) const {
  nlohmann::json report;
  report["input"] = input(state);
  report["settings"] = settings(state);
  for (const auto& [name, seconds] : phases_) report["phases"][name] = seconds;
  for (const auto& [name, bytes] : peaks_) report["memory"]["peak_by_end_of"][name] = bytes;
  if (memory_limit_ > 0) {
    report["memory"]["limit"] = memory_limit_;
    report["memory"]["made_coarser"] = state.schedule.short_of_memory != 0;
  }
  report["wall_seconds"] = std::chrono::duration<double>(Clock::now() - start_).count();
  report["cpu_seconds"] = cpu_seconds();
  report["peak_rss_bytes"] = peak_resident_bytes();
  int sweeps = 0;
  for (const IterationRecord& i : state.history) sweeps += i.sweeps;
  const std::uint64_t through_clusters = state.visibility->ray_total();
  report["rays"] = {
      {"exact", state.world->rays.ray_total()},
      {"multi_resolution", through_clusters},
      {"nodes_per_ray", static_cast<double>(state.visibility->node_total()) /
                            static_cast<double>(std::max<std::uint64_t>(1, through_clusters))}};
  report["clusters"] = state.tree.cluster_total();
  report["elements"] = state.tree.size();
  report["links"] = state.history.empty() ? state.link_total() : state.history.back().links;
  report["sweeps"] = sweeps;
  const EnergyBalance energy = energy_balance(state);
  report["energy"] = {{"emitted", rgb(energy.emitted)},
                      {"absorbed", rgb(energy.absorbed)},
                      {"escaped", rgb(energy.escaped)}};
  report["mean_irradiance"] = mean_irradiance(state);
  if (error_) {
    report["estimated_error"] = error_->relative_rms;
    report["estimated_error_noise"] = error_->least;
  }
  report["history"] = history(state);
  report["warnings"] = state.world->scene.warnings;
  if (has_mesh_)
    report["lit_mesh"] = {{"vertices", mesh_vertices_},
                          {"triangles", mesh_triangles_},
                          {"readings", mesh_readings_},
                          {"exposure", exposure_}};
  if (lightmap_)
    report["lightmap"] = {{"size", lightmap_->size},
                          {"charts", lightmap_->charts},
                          {"texels_read", lightmap_->read},
                          {"texels_covered", lightmap_->covered},
                          {"texels_per_metre", lightmap_->texels_per_metre},
                          {"filled", lightmap_->filled},
                          {"seam_difference_as_read", lightmap_->seams_as_read},
                          {"seam_difference", lightmap_->seams}};
  // Names that are not UTF-8 are shown with the sign for what is not known.
  return report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace halflight
