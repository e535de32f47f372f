#include "experiments/figure9.h"

#include <chrono>

#include <fmt/format.h>

#include "experiments/figures.h"
#include "halflight/base/parallel.h"
#include "halflight/features/compare.h"
#include "halflight/features/feature_mask.h"
#include "halflight/hierarchy/bodies.h"
#include "halflight/hierarchy/size_grid.h"
#include "halflight/output/false_colour.h"
#include "halflight/rays/world.h"
#include "halflight/scene/procedural/cube_groups.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight::experiments {
namespace {

constexpr int kSeed = 1;
constexpr int kWidth = kGroups * kWallPixels;
constexpr float kPixel = 0.01f;        // metres
constexpr float kLightDistance = 6.f;  // metres
constexpr float kLightSide = 0.04f;    // metres
constexpr int kLightSamples = 4;       // along each side of the light
constexpr float kErrorScale = 30.f;    // grey levels: yellow in the error pictures
constexpr std::array kPaperSeconds{2069, 1984, 1648, 1459, 1356};

// The paper's grids over whole cubes: each is a cluster of its sides, the last that visibility
// knows.
ClusterTree cluster_bodies(const Surfaces& surfaces) {
  const Bodies& bodies = surfaces.bodies;
  std::vector<Bounds3f> boxes(bodies.size());
  std::vector<std::vector<SurfaceId>> sides(boxes.size());
  for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
    const Surface& surface = surfaces[SurfaceId(i)];
    const BodyId body = bodies.of_triangle[surfaces.triangles[surface.first_triangle]];
    boxes[body.value].extend(surface.box);
    sides[body.value].emplace_back(i);
  }
  ClusterTree tree = build_size_grid(boxes);
  for (std::size_t c = 0, n = tree.clusters.size(); c < n; ++c) {
    const std::vector<SurfaceId> members = std::move(tree.clusters[c].surfaces);
    tree.clusters[c].surfaces.clear();
    for (const SurfaceId body : members) {
      tree.clusters[c].clusters.push_back(static_cast<std::uint32_t>(tree.clusters.size()));
      tree.clusters.push_back({{}, std::move(sides[body.value])});
    }
  }
  return tree;
}

MultiresTree build_tree(const World& world, const Surfaces& surfaces) {
  MultiresOptions options;
  options.blocker_size = BlockerSizeRule::isotropic;
  options.extinction = ExtinctionRule::area;
  options.receiver_clearance = 0.f;
  return {world.scene, world.geometry, surfaces, cluster_bodies(surfaces), options};
}

float light_pixel(const World& world, const MultiresTree& tree, const Vec3& on_wall,
                  const StopRule& rule, TraversalCount& count) {
  const Vec3 from = world.rays.lift(on_wall, Vec3(0.f, 0.f, 1.f));
  float seen = 0.f;
  for (int i = 0; i < kLightSamples; ++i)
    for (int j = 0; j < kLightSamples; ++j) {
      const Vec2 place = (Vec2(i, j) + 0.5f) / static_cast<float>(kLightSamples) - 0.5f;
      const Vec3 to =
          world.rays.lift(Vec3(kLightSide * place, kLightDistance), Vec3(0.f, 0.f, -1.f));
      seen += tree.average({from, to - from, 1.f}, rule, &count);
    }
  return seen / (kLightSamples * kLightSamples);
}

MultiresWall light_wall(const World& world, const MultiresTree& tree, double feature_size) {
  MultiresWall lit;
  lit.feature_size = feature_size;
  lit.wall = Image(kWidth, kWallPixels);
  lit.visibility.resize(lit.wall.pixels.size());
  const StopRule rule =
      feature_size > 0.0 ? StopRule::between(kPixel * static_cast<float>(feature_size), kLightSide)
                         : StopRule::never();
  std::vector<TraversalCount> counts(kWallPixels);
  const auto start = std::chrono::steady_clock::now();
  parallel_for(kWallPixels, 4, [&](std::size_t row) {
    const float up = 0.5f * kWallPixels - static_cast<float>(row) - 0.5f;
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 on_wall = kPixel * Vec3(static_cast<float>(x) + 0.5f - 0.5f * kWidth, up, 0.f);
      const float seen = light_pixel(world, tree, on_wall, rule, counts[row]);
      lit.visibility[row * kWidth + static_cast<std::size_t>(x)] = seen;
      // Without the falloff to the sides, so that the groups can be compared.
      lit.wall.at(x, static_cast<int>(row)) = Rgb(static_cast<float>(kFullLight) * seen);
    }
  });
  lit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const TraversalCount& count : counts) {
    lit.nodes_per_ray += static_cast<double>(count.nodes);
    lit.clusters_per_ray += static_cast<double>(count.clusters);
  }
  const double rays = kWidth * kWallPixels * kLightSamples * kLightSamples;
  lit.nodes_per_ray /= rays;
  lit.clusters_per_ray /= rays;
  return lit;
}

void judge(MultiresWall& lit, const MultiresWall& reference) {
  CompareOptions options;
  if (lit.feature_size > 0.0) options.feature_sizes = {lit.feature_size};
  for (int group = 0; group < kGroups; ++group)
    options.parts.push_back({group * kWallPixels, 0, kWallPixels, kWallPixels});
  const BinaryImage shadow = shadow_of(reference.visibility, kWidth, kWallPixels);
  const Comparison c = compare(reference.wall, lit.wall, shadow, options);
  for (std::size_t group = 0; group < kGroups; ++group) {
    lit.l2[group] = c.parts[group].l2;
    if (!c.at_sizes.empty()) lit.fbem[group] = c.at_sizes.front().parts[group];
  }
}

std::string name_of(const MultiresWall& lit) {
  return lit.feature_size > 0.0 ? fmt::format("s = {:g}", lit.feature_size) : "reference";
}

}  // namespace

std::vector<MultiresWall> light_wall_by_multires(int seed) {
  CubeGroupsParameters parameters;
  parameters.seed = seed;
  const World world(cube_groups_scene(parameters));
  const Surfaces surfaces = build_surfaces(world.geometry);
  const MultiresTree tree = build_tree(world, surfaces);
  std::vector<MultiresWall> walls{light_wall(world, tree, 0.0)};
  for (const double s : kFeatureSizes) walls.push_back(light_wall(world, tree, s));
  for (MultiresWall& lit : walls) judge(lit, walls.front());
  return walls;
}

Result<Section> run_figure9(const Progress& progress) {
  progress.report("figure9", 0.0);
  const std::vector<MultiresWall> walls = light_wall_by_multires(kSeed);
  if (progress.cancelled()) return system_error("interrupted", "figure9");
  Section section{
      "figure9", "Figure 9: multi-resolution visibility at rising feature sizes", {}, {}};
  PictureRow lit{"The wall behind the four groups", {}};
  PictureRow errors{
      fmt::format("Difference from the reference, from 0 (dark blue) to {:g} (yellow)",
                  kErrorScale),
      {}};
  Table costs{"Cost",
              {"feature size, cm", "time, s", "nodes for each ray", "clusters for each ray",
               "paper's time, s"},
              {}};
  Table norms{"L2 and FBEM (with the same feature size) of each group, in grey levels",
              {"feature size, cm"},
              {}};
  for (const double size : kShadowSizes)
    norms.head.push_back(fmt::format("shadows of {:g} cm: L2, FBEM", size));
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const MultiresWall& w = walls[i];
    const std::string name = name_of(w);
    lit.pictures.push_back({fmt::format("figure9-wall-{}", i), grey_picture(w.wall), name});
    costs.rows.push_back(
        {name, fmt::format("{:.2f}", w.seconds), fmt::format("{:.2f}", w.nodes_per_ray),
         fmt::format("{:.2f}", w.clusters_per_ray), fmt::format("{}", kPaperSeconds[i])});
    nlohmann::ordered_json number{{"feature_size", w.feature_size},
                                  {"seconds", w.seconds},
                                  {"nodes_per_ray", w.nodes_per_ray},
                                  {"clusters_per_ray", w.clusters_per_ray}};
    if (i > 0) {
      errors.pictures.push_back(
          {fmt::format("figure9-error-{}", i),
           false_colour_image(local_error(difference(walls.front().wall, w.wall), 2), kWidth,
                              kWallPixels, kErrorScale),
           name});
      norms.rows.push_back({name});
      for (std::size_t group = 0; group < kGroups; ++group)
        norms.rows.back().push_back(fmt::format("{:.2f}, {:.2f}", w.l2[group], w.fbem[group]));
      number["l2"] = w.l2;
      number["fbem"] = w.fbem;
    }
    section.numbers.push_back(number);
  }
  section.blocks = {
      "Visibility by extinction alone, as in section 5 of the paper: the reference opens every "
      "cluster, the others stop where the umbra of a blocker of the cluster's BSIZE is below the "
      "feature size. From the left, groups are averaged one after another as the feature size "
      "passes their shadows; what is lost is small in the feature-based metric, and costs fall.",
      lit, errors, costs, norms};
  return section;
}

}  // namespace halflight::experiments
