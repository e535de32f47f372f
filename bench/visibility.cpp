// Rays per second of exact (Embree), average and multi-resolution visibility, from points on the
// floor to a light on the ceiling through clutter of rising size.
//
//   bench_visibility --benchmark_filter=plants/65536
//
// Names: scene / triangles or small things / light / order of the rays / visibility at s as a share
// of the scene's longest side. Beside the time: nodes and triangle blocks looked into for each ray,
// mean transmittance and how far it is from the exact mean, and the variance of rays within cells
// of side s as a share of that of exact rays: so many fewer rays are needed.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "halflight/base/hash.h"
#include "halflight/base/morton.h"
#include "halflight/hierarchy/size_grid.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"
#include "halflight/visibility/multires_build.h"
#include "halflight/visibility/visibility.h"

namespace halflight {
namespace {

constexpr std::size_t kRays = 1u << 16;

struct Case {
  std::string scene;
  int count;
  bool size_grid = false;  // clusters of the solver; else the tree's own

  friend bool operator==(const Case&, const Case&) = default;
};

struct Loaded {
  Case what;
  std::unique_ptr<World> world;
  Surfaces surfaces;
  ClusterTree clusters;
  std::unique_ptr<MultiresTree> tree;
  double cluster_seconds = 0.0, tree_seconds = 0.0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// One scene at a time stays in memory.
const Loaded& load(const Case& what) {
  static Loaded loaded;
  if (loaded.tree && loaded.what == what) return loaded;
  loaded = {};
  loaded.what = what;
  loaded.world = std::make_unique<World>(what.scene == "plants" ? plants_scene({what.count, 1})
                                                                : office_scene({what.count, 1}));
  const World& world = *loaded.world;
  loaded.surfaces = build_surfaces(world.geometry);
  std::vector<Bounds3f> boxes;
  for (const Surface& s : loaded.surfaces.surfaces) boxes.push_back(s.box);
  auto start = std::chrono::steady_clock::now();
  loaded.clusters = what.size_grid ? build_size_grid(boxes) : one_cluster(loaded.surfaces);
  loaded.cluster_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  loaded.tree =
      std::make_unique<MultiresTree>(world.scene, world.geometry, loaded.surfaces, loaded.clusters);
  loaded.tree_seconds = seconds_since(start);
  if (world.geometry.triangles.size() < 100000) {
    start = std::chrono::steady_clock::now();
    MultiresOptions pictures;
    pictures.blocker_size = BlockerSizeRule::isotropic;
    const MultiresTree pictured(world.scene, world.geometry, loaded.surfaces, loaded.clusters,
                                pictures);
    fmt::print(stderr, "tree with pictures {:.2f} s\n", seconds_since(start));
  }
  fmt::print(stderr, "{}{} {}: {} triangles, {} nodes; size grid {:.2f} s, tree {:.2f} s\n",
             what.scene, what.size_grid ? "-size-grid" : "", what.count,
             world.geometry.triangles.size(), loaded.tree->arrays().nodes.size(),
             loaded.cluster_seconds, loaded.tree_seconds);
  return loaded;
}

// From just above the floor to a light of `size` below the middle of the ceiling.
std::vector<RayEnds> floor_to_light(const Bounds3f& room, float size, bool sorted) {
  std::vector<RayEnds> rays(kRays);
  const Vec3 e = room.extent();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto number = [&](int k) { return to_unit_float(hash(i, k)); };
    rays[i].receiver =
        room.lower + e * Vec3(0.05f + 0.9f * number(0), 0.01f, 0.05f + 0.9f * number(1));
    rays[i].emitter = room.lower + e * Vec3(0.5f, 0.9f, 0.5f) +
                      size * Vec3(number(2) - 0.5f, 0.f, number(3) - 0.5f);
    rays[i].emitter_size = size;
  }
  if (sorted)
    std::sort(rays.begin(), rays.end(), [&](const RayEnds& a, const RayEnds& b) {
      return morton_code(a.receiver, room) < morton_code(b.receiver, room);
    });
  return rays;
}

// Mean variance of single rays within square floor cells of side `cell`, each ray to its own place
// on the light: what has to be averaged away.
template <class Light>
double variance_in_cells(const Bounds3f& room, float cell, float size, const Light& light_of) {
  constexpr int kCells = 512, kRaysPerCell = 32;
  double sum = 0.0;
  for (std::uint64_t c = 0; c < kCells; ++c) {
    const auto number = [&](std::uint64_t ray, int k) { return to_unit_float(hash(c, ray, k)); };
    double first = 0.0, second = 0.0;
    for (std::uint64_t i = 1; i <= kRaysPerCell; ++i) {
      RayEnds r;
      r.receiver =
          room.lower +
          room.extent() * Vec3(0.05f + 0.85f * number(0, 0), 0.01f, 0.05f + 0.85f * number(0, 1)) +
          cell * Vec3(number(i, 2), 0.f, number(i, 3));
      r.emitter = room.lower + room.extent() * Vec3(0.5f, 0.9f, 0.5f) +
                  size * Vec3(number(i, 4) - 0.5f, 0.f, number(i, 5) - 0.5f);
      r.emitter_size = size;
      const double light = light_of(r);
      first += light;
      second += light * light;
    }
    sum += (second - first * first / kRaysPerCell) / (kRaysPerCell - 1);
  }
  return sum / kCells;
}

enum class Way { exact, tree_exact, average, multires };

void shoot(benchmark::State& state, const Case& what, float light, bool sorted, Way way,
           float share) {
  const Loaded& loaded = load(what);
  const World& world = *loaded.world;
  const Bounds3f& room = world.geometry.bounds;
  const auto rays = floor_to_light(room, light, sorted);
  const float s = share * room.longest_side();
  TraversalCount count;
  const auto light_of = [&](const RayEnds& r, TraversalCount* c) {
    const VisibilityRay ray{r.receiver, r.emitter - r.receiver, 1.f};
    const StopRule rule = StopRule::between(s, r.emitter_size);
    switch (way) {
      case Way::exact:
        return world.rays.transmittance(r.receiver, r.emitter);
      case Way::tree_exact:
        return loaded.tree->multires(ray, StopRule::never(), c);
      case Way::average:
        return loaded.tree->average(ray, rule, c);
      case Way::multires:
        break;
    }
    return loaded.tree->multires(ray, rule, c);
  };
  double mean = 0.0, exact = 0.0;
  for (const RayEnds& r : rays) {
    mean += light_of(r, &count) / kRays;
    exact += world.rays.transmittance(r.receiver, r.emitter) / kRays;
  }
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(light_of(rays[i], nullptr));
    i = (i + 1) % kRays;
  }
  state.counters["Mray/s"] = benchmark::Counter(static_cast<double>(state.iterations()) * 1e-6,
                                                benchmark::Counter::kIsRate);
  state.counters["nodes"] = static_cast<double>(count.nodes) / kRays;
  state.counters["blocks"] = static_cast<double>(count.blocks) / kRays;
  state.counters["stops"] = static_cast<double>(count.stops) / kRays;
  const auto way_light = [&](const RayEnds& r) { return light_of(r, nullptr); };
  const auto exact_light = [&](const RayEnds& r) {
    return world.rays.transmittance(r.receiver, r.emitter);
  };
  if (s > 0.f)
    state.counters["variance"] = variance_in_cells(room, s, light, way_light) /
                                 std::max(variance_in_cells(room, s, light, exact_light), 1e-9);
  state.counters["mean"] = mean;
  state.counters["bias"] = mean - exact;
}

// Rays of all directions from the floor up, to the nearest surface or stopped cluster.
void follow(benchmark::State& state, const Case& what, bool exact, float share) {
  const Loaded& loaded = load(what);
  const auto rays = floor_to_light(loaded.world->geometry.bounds, 0.f, false);
  const StopRule rule =
      StopRule::widening(share * loaded.world->geometry.bounds.longest_side(), 0.05f);
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec2 u(to_unit_float(hash(i, 8)), to_unit_float(hash(i, 9)));
    const Vec3 d = Frame::from_normal({0, 1, 0}).to_world(cosine_hemisphere(u));
    if (exact)
      benchmark::DoNotOptimize(loaded.world->rays.closest_hit(rays[i].receiver, d, kInfinity, i));
    else
      benchmark::DoNotOptimize(loaded.tree->closest_hit({rays[i].receiver, d}, rule, i));
    i = (i + 1) % kRays;
  }
  state.counters["Mray/s"] = benchmark::Counter(static_cast<double>(state.iterations()) * 1e-6,
                                                benchmark::Counter::kIsRate);
}

void register_all() {
  const std::vector<Case> cases{
      {"plants", 1 << 16}, {"plants", 1 << 19}, {"plants", 1 << 21},       {"office", 1200},
      {"office", 8000},    {"office", 32000},   {"plants", 1 << 19, true}, {"office", 32000, true}};
  for (const Case& c : cases) {
    for (const float share : {0.f, 0.01f, 0.04f})
      benchmark::RegisterBenchmark(
          fmt::format("{}{}/{}/closest/random/{}", c.scene, c.size_grid ? "-size-grid" : "",
                      c.count, share > 0.f ? fmt::format("multires@{:g}%", 100.f * share) : "exact")
              .c_str(),
          [=](benchmark::State& state) { follow(state, c, share == 0.f, share); })
          ->MinTime(0.3);
    for (const float light : {1.f, 0.f})
      for (const bool sorted : {false, true}) {
        const auto add = [&](const std::string& name, Way way, float share) {
          benchmark::RegisterBenchmark(
              fmt::format("{}{}/{}/{}/{}/{}", c.scene, c.size_grid ? "-size-grid" : "", c.count,
                          light > 0.f ? "area" : "point", sorted ? "sorted" : "random", name)
                  .c_str(),
              [=](benchmark::State& state) { shoot(state, c, light, sorted, way, share); })
              ->MinTime(0.3);
        };
        add("exact", Way::exact, 0.f);
        add("tree_exact", Way::tree_exact, 0.f);
        for (const float share : {0.002f, 0.01f, 0.04f, 0.1f}) {
          add(fmt::format("average@{:g}%", 100.f * share), Way::average, share);
          add(fmt::format("multires@{:g}%", 100.f * share), Way::multires, share);
        }
      }
  }
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  halflight::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
