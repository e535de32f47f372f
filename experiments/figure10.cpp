#include "experiments/figure10.h"

#include <array>
#include <chrono>

#include <fmt/format.h>

#include "experiments/figures.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/rays/camera_rays.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/books.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"
#include "halflight/solve/solver.h"
#include "halflight/transport/item_buffer.h"
#include "halflight/transport/sampled_links.h"

namespace halflight::experiments {
namespace {

constexpr int kSeed = 1;
constexpr int kWidth = 480, kHeight = 480;
constexpr float kCell = 0.04f;       // metres: the items of the one link
constexpr int kCountedLines = 1024;  // along each side of the silhouette's square
constexpr int kSilhouetteRays = 16;  // on each item, to know whether anything of it is seen
constexpr std::size_t kMostItems = 2000;
constexpr float kBookExposure = 1.f;  // of irradiance handed out, as a share of the facing one
constexpr float kSurroundings = 0.12f;
constexpr float kLinkWidth = 0.004f;  // radians
constexpr Rgb kPurple{0.5f, 0.1f, 0.6f};
struct SolvedScene {
  const char* name;
  Scene (*build)();
  float feature_size;  // metres
};
constexpr std::array kSolvedScenes{
    SolvedScene{"books", [] { return books_scene(); }, 0.4f},
    SolvedScene{"office", [] { return office_scene({.count = 300}); }, 0.3f},
    SolvedScene{"plants", [] { return plants_scene({.count = 16000}); }, 0.3f}};
constexpr std::uint32_t kReferencePoints = 8, kReferencePaths = 256;

bool is_book(const Scene& scene, const Geometry& g, TriangleId t) {
  return scene.nodes[g.primitive_instances[g.instances[t]].node].name.starts_with("book ");
}

// The books are one cluster, everything else hangs on the root.
ClusterTree books_as_one(const World& world, const Surfaces& surfaces) {
  ClusterTree tree;
  tree.clusters.resize(2);
  tree.root = 0;
  tree.clusters[0].clusters = {1};
  for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
    const TriangleId t = surfaces.triangles[surfaces[SurfaceId(i)].first_triangle];
    tree.clusters[is_book(world.scene, world.geometry, t) ? 1 : 0].surfaces.emplace_back(i);
  }
  return tree;
}

Scene books_alone(Scene scene) {
  for (Node& node : scene.nodes)
    if (!node.name.starts_with("book ")) node.mesh = {};
  return scene;
}

struct BookCells {
  World world;
  World books;  // alone
  Surfaces surfaces;
  ElementTree tree;
  IdVector<ElementId, float> opacity;
  std::vector<ElementId> items;
  Vec3 to_light{0.f};  // unit
  Vec3 center{0.f}, light{0.f};

  explicit BookCells(const Scene& scene)
      : world(scene),
        books(books_alone(scene)),
        surfaces(build_surfaces(world.geometry)),
        tree(world.geometry, surfaces, books_as_one(world, surfaces),
             find_live_sides(world.scene, world.geometry, surfaces, world.rays)) {
    const ElementId cluster = tree.cluster_element(1);
    std::vector<ElementId> open{cluster};
    while (!open.empty()) {
      const ElementId e = open.back();
      open.pop_back();
      if (tree[e].is_leaf_cell() && tree.cell_size(e) > kCell) tree.split(e);
      for (const ElementId child : tree[e].children()) open.push_back(child);
      if (tree[e].is_leaf()) items.push_back(e);
    }
    opacity = IdVector<ElementId, float>(tree.size(), 1.f);
    center = tree[cluster].center();
    Bounds3f box;
    for (std::size_t i = 0; i < world.geometry.triangles.size(); ++i)
      if (world.scene.materials[world.geometry.materials[TriangleId(i)]].emits())
        for (const Vec3& corner : world.geometry.corners(TriangleId(i))) box.extend(corner);
    light = box.center();
    to_light = glm::normalize(light - center);
  }
};

// Parallel lines towards the light, on a square that covers the books: the area over which they
// meet one.
double count_silhouette(const BookCells& cells) {
  const Bounds3f& box = cells.books.geometry.bounds;
  const Frame frame = Frame::from_normal(cells.to_light);
  const float side = box.diagonal(), pixel = side / kCountedLines;
  const auto lines =
      parallel_sum(std::size_t{kCountedLines}, 8, std::uint64_t{0}, [&](std::size_t row) {
        std::uint64_t met = 0;
        for (int x = 0; x < kCountedLines; ++x) {
          const Vec2 at = pixel * (Vec2(x, row) + 0.5f) - 0.5f * side;
          const Vec3 from = box.center() + frame.to_world(Vec3(at, side));
          if (cells.books.rays.closest_hit(from, -cells.to_light, kInfinity, 1)) ++met;
        }
        return met;
      });
  return static_cast<double>(pixel * pixel) * static_cast<double>(lines);
}

bool is_hidden(const BookCells& cells, ElementId item) {
  const Vec3 n = cells.tree.normal(item);
  for (std::uint32_t k = 0; k < kSilhouetteRays; ++k) {
    const Vec3 x = cells.tree.sample(item, r2_sequence(k)).position;
    if (!cells.books.rays.closest_hit(cells.books.rays.lift(x, n), cells.to_light, kInfinity, k))
      return false;
  }
  return true;
}

// Seen from the eye, the direction d passes over the segment from a to b.
bool on_segment(const Vec3& eye, const Vec3& d, const Vec3& a, const Vec3& b) {
  const Vec3 n = glm::normalize(glm::cross(a - eye, b - eye));
  return std::abs(glm::dot(d, n)) < kLinkWidth && glm::dot(glm::cross(a - eye, d), n) > 0.f &&
         glm::dot(glm::cross(d, b - eye), n) > 0.f;
}

// Books show what was handed out to their cells, in units of the irradiance of what faces the
// light.
Image picture_books(const BookCells& cells, const IdVector<ElementId, float>& given, int width,
                    int height) {
  const Geometry& g = cells.world.geometry;
  const PlacedCamera& camera = g.cameras.front();
  const CameraRays rays(camera, width, height);
  Image image(width, height);
  parallel_for(static_cast<std::size_t>(height), 4, [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const CameraRay ray = rays.through(Vec2(x, y) + 0.5f);
      Rgb& pixel = image.at(x, static_cast<int>(y));
      pixel = Rgb(0.f);
      if (const auto hit = cells.world.rays.closest_hit(ray.origin, ray.direction, kInfinity, 1)) {
        const Rgb reflectance =
            reflectance_at(cells.world.scene, g, hit->triangle, hit->barycentric);
        const ElementId cell = cells.tree.leaf_hit(*hit);
        const bool book = is_book(cells.world.scene, g, hit->triangle) && cell.valid();
        pixel = reflectance * (book ? kSurroundings + given[cell] / kBookExposure : kSurroundings);
      }
      if (on_segment(ray.origin, ray.direction, cells.center, cells.light)) pixel = kPurple;
    }
  });
  return image;
}

// Irradiance by path tracing, mean over some points of each side.
std::vector<float> trace_items(const World& world, const ElementTree& tree,
                               const std::vector<ElementId>& items) {
  const PathTracer tracer(world);
  std::vector<float> traced(items.size());
  parallel_for(items.size(), 4, [&](std::size_t i) {
    for (std::uint32_t k = 0; k < kReferencePoints; ++k) {
      const Vec3 x = tree.sample(items[i], r2_sequence(k)).position;
      traced[i] +=
          average(tracer.estimate_irradiance(x, tree.normal(items[i]), kReferencePaths, hash(i, k))
                      .mean) /
          kReferencePoints;
    }
  });
  return traced;
}

void judge(SolvedClusters& solved, const SolverState& state, const std::vector<ElementId>& items,
           const std::vector<float>& traced) {
  double area = 0, light = 0, difference = 0, squares = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto a = static_cast<double>(state.tree[items[i]].area);
    const auto d = static_cast<double>(average(state.irradiance[items[i]]) - traced[i]);
    area += a;
    light += a * static_cast<double>(traced[i]);
    difference += a * d;
    squares += a * d * d;
  }
  solved.items = items.size();
  solved.error = std::sqrt(squares / area) / (light / area);
  solved.bias = difference / light;
  const EnergyBalance energy = energy_balance(state);
  solved.absorbed = static_cast<double>(average(energy.absorbed) / average(energy.emitted));
}

// Of the sides inside clusters that receive as one and hide each other, some that are spread.
std::vector<ElementId> choose_items(const SolverState& state) {
  const ClusterVisibility inside(
      state.tree, state.opacity,
      choose_receivers(state.tree, {state.tree.root()}, state.receiver_sizes));
  std::vector<ElementId> all, chosen;
  for (const ElementId cluster : inside.clusters())
    for (const auto& item : inside.items(cluster)) all.push_back(item.cell);
  const std::size_t step = all.size() / kMostItems + 1;
  for (std::size_t i = 0; i < all.size(); i += step) chosen.push_back(all[i]);
  return chosen;
}

const char* on_off(bool on) { return on ? "on" : "off"; }

}  // namespace

LinkToBooks link_light_to_books(int seed, int width, int height) {
  BooksParameters parameters;
  parameters.seed = seed;
  const BookCells cells(books_scene(parameters));
  LinkToBooks link;
  link.items = cells.items.size();
  link.silhouette = count_silhouette(cells);
  const std::vector<float> visible =
      visible_areas(cells.tree, cells.items, cells.opacity, cells.to_light);
  IdVector<ElementId, float> with(cells.tree.size(), 0.f), without = with;
  std::vector<std::uint8_t> hidden(cells.items.size());
  parallel_for(hidden.size(), 16,
               [&](std::size_t i) { hidden[i] = is_hidden(cells, cells.items[i]); });
  for (std::size_t i = 0; i < cells.items.size(); ++i) {
    const ElementId item = cells.items[i];
    const float area = cells.tree[item].area;
    with[item] = visible[i] / area;
    without[item] = std::max(0.f, glm::dot(cells.tree.normal(item), cells.to_light));
    const double given_with = static_cast<double>(visible[i]);
    const double given_without = static_cast<double>(area * without[item]);
    link.given_with += given_with;
    link.given_without += given_without;
    if (!hidden[i]) continue;
    link.hidden_with += given_with;
    link.hidden_without += given_without;
  }
  link.with = picture_books(cells, with, width, height);
  link.without = picture_books(cells, without, width, height);
  return link;
}

std::vector<SolvedClusters> solve_with_and_without(Scene scene, float feature_size) {
  const auto world = make_world(std::move(scene));
  std::vector<ElementId> items;
  std::vector<float> traced;
  std::vector<SolvedClusters> all;
  for (const LinkMaker links : {LinkMaker::sampled, LinkMaker::refined})
    for (const bool intra_cluster : {false, true}) {
      SolveOptions options;
      options.feature_size = feature_size;
      options.links = links;
      options.intra_cluster = intra_cluster;
      const auto start = std::chrono::steady_clock::now();
      SolverState state = make_state(world, options);
      while (!state.done()) advance(state, Progress{});
      SolvedClusters solved{.refined_links = links == LinkMaker::refined,
                            .intra_cluster = intra_cluster};
      solved.seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (items.empty()) {
        items = choose_items(state);
        traced = trace_items(*world, state.tree, items);
      }
      judge(solved, state, items, traced);
      all.push_back(solved);
    }
  return all;
}

Result<Section> run_figure10(const Progress& progress) {
  progress.report("figure10", 0.0);
  const LinkToBooks link = link_light_to_books(kSeed, kWidth, kHeight);
  progress.report("figure10", 0.5);
  if (progress.cancelled()) return system_error("interrupted", "figure10");

  Section section{"figure10", "Figure 10: visibility inside a cluster of books", {}, {}};
  PictureRow books{"Light that one link (purple) hands out to the books",
                   {{"figure10-without", link.without, "without intra-cluster visibility"},
                    {"figure10-with", link.with, "with it"}}};
  const auto row = [&](const char* name, double given, double hidden) {
    return std::vector<std::string>{name, fmt::format("{:.4f}", given),
                                    fmt::format("{:+.1f} %", 100 * (given / link.silhouette - 1)),
                                    fmt::format("{:.4f}", hidden)};
  };
  Table arriving{
      "Light handed out, divided by the irradiance of what faces the source, m2",
      {"intra-cluster visibility", "to all books", "more than the silhouette", "to hidden cells"},
      {row("off", link.given_without, link.hidden_without),
       row("on", link.given_with, link.hidden_with),
       {"silhouette, 1024 x 1024 lines", fmt::format("{:.4f}", link.silhouette), "", ""}}};
  Table solutions{
      "Scenes solved: irradiance of the sides inside clusters that receive as one, against path "
      "tracing",
      {"scene", "feature size, m", "links", "intra-cluster visibility", "RMS error", "bias",
       "absorbed of emitted", "time, s"},
      {}};
  section.numbers = {{"items", link.items},
                     {"silhouette", link.silhouette},
                     {"given_with", link.given_with},
                     {"given_without", link.given_without},
                     {"hidden_with", link.hidden_with},
                     {"hidden_without", link.hidden_without},
                     {"solved", nlohmann::ordered_json::array()}};
  for (const auto& [name, build, feature_size] : kSolvedScenes) {
    if (progress.cancelled()) return system_error("interrupted", "figure10");
    for (const SolvedClusters& s : solve_with_and_without(build(), feature_size)) {
      const char* links = s.refined_links ? "refined" : "sampled";
      solutions.rows.push_back(
          {name, fmt::format("{:.1f}", feature_size), links, on_off(s.intra_cluster),
           fmt::format("{:.1f} %", 100 * s.error), fmt::format("{:+.1f} %", 100 * s.bias),
           fmt::format("{:.2f} %", 100 * s.absorbed), fmt::format("{:.2f}", s.seconds)});
      section.numbers["solved"].push_back({{"scene", name},
                                           {"feature_size", feature_size},
                                           {"links", links},
                                           {"intra_cluster", s.intra_cluster},
                                           {"items", s.items},
                                           {"error", s.error},
                                           {"bias", s.bias},
                                           {"absorbed", s.absorbed},
                                           {"seconds", s.seconds}});
    }
  }
  section.blocks = {
      fmt::format(
          "Seen from the light, {:.1f} front faces of books lie one behind the other. A link that "
          "lights all of them creates that much energy; an item buffer hands the light to what is "
          "seen. In the solver the weights of links know from their rays how much arrives, with "
          "intra-cluster visibility or without: there the buffer says where.",
          link.given_without / link.silhouette),
      books, arriving, solutions};
  return section;
}

}  // namespace halflight::experiments
