#include "inspect_hierarchy.h"

#include <chrono>

#include <fmt/format.h>

#include "halflight/hierarchy/build_hierarchy.h"

namespace halflight::app {
namespace {

using nlohmann::json;

json to_json(const RayQuality& rays) {
  return {{"nodes_per_ray", rays.nodes},
          {"rays_per_second", rays.per_second},
          {"mean_transmittance", rays.mean},
          {"rms_error", rays.rms}};
}

}  // namespace

std::vector<std::string> hierarchy_choices() {
  std::vector<std::string> choices{"all"};
  for (const NamedHierarchy& h : kHierarchies) choices.emplace_back(h.name);
  return choices;
}

std::vector<InspectedHierarchy> inspect_hierarchies(const Scene& scene, const std::string& choice) {
  const World world(scene);
  const Surfaces surfaces = build_surfaces(world.geometry);
  std::vector<InspectedHierarchy> inspected;
  for (const NamedHierarchy& h : kHierarchies) {
    if (choice != "all" && choice != h.name) continue;
    const auto start = std::chrono::steady_clock::now();
    const ClusterTree tree = build_hierarchy(h.kind, surfaces);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    inspected.push_back(
        {std::string(h.name), time.count(), measure_hierarchy(world, surfaces, tree)});
  }
  return inspected;
}

json hierarchies_json(const std::vector<InspectedHierarchy>& hierarchies) {
  json all = json::array();
  for (const auto& [name, build_seconds, m] : hierarchies) {
    json extinction = json::array();
    for (const ExtinctionQuality& e : m.extinction)
      extinction.push_back({{"largest_share_of_scene", e.largest},
                            {"clusters", e.clusters},
                            {"bias", e.bias},
                            {"rms", e.rms}});
    all.push_back({{"name", name},
                   {"build_seconds", build_seconds},
                   {"bytes", m.bytes},
                   {"visibility_bytes", m.visibility_bytes},
                   {"clusters", m.clusters},
                   {"depth", m.depth},
                   {"fan_out", m.fan_out},
                   {"largest_fan_out", m.largest_fan_out},
                   {"empty_space", m.empty_space},
                   {"size_spread", m.size_spread},
                   {"extinction", extinction},
                   {"exact", to_json(m.exact)},
                   {"average", to_json(m.average)},
                   {"multires", to_json(m.multires)}});
  }
  return all;
}

void print_hierarchies(const std::vector<InspectedHierarchy>& hierarchies) {
  for (const auto& [name, build_seconds, m] : hierarchies) {
    fmt::print("hierarchy  {}: {} clusters, {} levels, built in {:.3f} s, {:.1f} MiB\n", name,
               m.clusters, m.depth, build_seconds, static_cast<double>(m.bytes) / 0x1p20);
    fmt::print("  members {:.2f}, at most {}; empty space {:.2f}; sizes within {:.2f} octaves\n",
               m.fan_out, m.largest_fan_out, m.empty_space, m.size_spread);
    for (const ExtinctionQuality& e : m.extinction)
      if (e.clusters > 0)
        fmt::print(
            "  extinction, clusters up to {:>6.1f} % of the scene: bias {:+.3f}, rms {:.3f}\n",
            100.0 * e.largest, e.bias, e.rms);
    for (const auto& [what, rays] : {std::pair("exact", m.exact), std::pair("average", m.average),
                                     std::pair("multires", m.multires)})
      fmt::print(
          "  {:<9} {:5.1f} nodes a ray, {:5.2f} Mray/s, transmittance {:.3f}, rms error {:.3f}\n",
          what, rays.nodes, 1e-6 * rays.per_second, rays.mean, rays.rms);
  }
}

}  // namespace halflight::app
