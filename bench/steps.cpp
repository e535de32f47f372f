// The steps of a solve one by one, on an office with so many small things: what a change to one of
// them gains. Traversal has benchmarks of its own (visibility.cpp, embree.cpp), as have the
// hierarchies over size and threads (hierarchy.cpp).
//
//   bench_steps --benchmark_filter=sweep
//
// Names: step / small things in the office. items_per_second: triangles, pairs, points or elements,
// as the step's comment says.
#include <benchmark/benchmark.h>

#include <fmt/format.h>

#include <array>
#include <map>

#include "halflight/hierarchy/build_hierarchy.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/solve/sweep.h"
#include "halflight/transport/emitter_tree.h"
#include "halflight/transport/form_factor.h"
#include "halflight/transport/item_buffer.h"
#include "halflight/transport/sampled_links.h"
#include "halflight/transport/transfer.h"
#include "halflight/visibility/blocker_size.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight {
namespace {

constexpr std::array kSmallThings{1'000, 10'000};
constexpr float kFeatureSize = 0.1f;

// Solved once for each number of things.
const SolverState& solved(int things) {
  static std::map<int, SolverState> states;
  const auto found = states.find(things);
  if (found != states.end()) return found->second;
  SolverState state =
      make_state(make_world(office_scene({things, 1})), {.feature_size = kFeatureSize});
  while (!state.done()) advance(state, Progress());
  return states.emplace(things, std::move(state)).first->second;
}

void count_items(benchmark::State& run, std::size_t items) {
  run.SetItemsProcessed(static_cast<std::int64_t>(items) * run.iterations());
}

// Triangles.
void surfaces(benchmark::State& run, int things) {
  const Geometry& g = solved(things).world->geometry;
  for (auto _ : run) benchmark::DoNotOptimize(build_surfaces(g));
  count_items(run, g.triangles.size());
}

// Triangles.
void live_sides(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  const World& world = *state.world;
  for (auto _ : run)
    benchmark::DoNotOptimize(
        find_live_sides(world.scene, world.geometry, *state.surfaces, world.rays));
  count_items(run, world.geometry.triangles.size());
}

// Clusters over the office's surfaces: surfaces.
void hierarchy(benchmark::State& run, int things, HierarchyKind kind) {
  const Surfaces& surfaces = *solved(things).surfaces;
  for (auto _ : run) benchmark::DoNotOptimize(build_hierarchy(kind, surfaces));
  count_items(run, surfaces.surfaces.size());
}

// Nodes that rays are stopped in, with blocker sizes and extinction: triangles.
void multires_tree(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  const World& world = *state.world;
  const ClusterTree clusters = build_hierarchy(state.options.hierarchy, *state.surfaces);
  for (auto _ : run)
    benchmark::DoNotOptimize(MultiresTree(world.scene, world.geometry, *state.surfaces, clusters));
  count_items(run, world.geometry.triangles.size());
}

// Pictures of the whole office from all directions: triangles.
void blocker_sizes(benchmark::State& run, int things) {
  const World& world = *solved(things).world;
  const Geometry& g = world.geometry;
  std::vector<TriangleId> contents(g.triangles.size());
  for (std::size_t t = 0; t < contents.size(); ++t) contents[t] = TriangleId(t);
  for (auto _ : run)
    benchmark::DoNotOptimize(measure_blocker_sizes(world.scene, g, contents, g.bounds));
  count_items(run, contents.size());
}

// Points that see a triangle in closed form.
void form_factors(benchmark::State& run, int) {
  const std::array<Vec3, 3> triangle{Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(0, 1, 1)};
  std::size_t k = 0;
  for (auto _ : run) {
    const Vec2 u = r2_sequence(static_cast<std::uint32_t>(++k));
    benchmark::DoNotOptimize(polygon_form_factor({4.f * u.x, 0, 4.f * u.y}, {0, 1, 0}, triangle));
  }
  count_items(run, 1);
}

// Pairs of elements, 16 samples each.
void transfers(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  const TransferScene scene{state.tree,      *state.visibility, kFeatureSize,
                            state.radiosity, state.opacity,     state.inside.get()};
  std::size_t k = 0;
  for (auto _ : run) {
    ++k;
    const ElementId r(static_cast<std::size_t>(hash(k, 1) % state.tree.size())),
        s(static_cast<std::size_t>(hash(k, 2) % state.tree.size()));
    if (r != s) benchmark::DoNotOptimize(estimate_transfer(scene, r, s, 16, 1));
  }
  count_items(run, 1);
}

// Inside of all clusters that receive as one, from all directions: elements.
void item_buffers(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  const auto receivers = choose_receivers(state.tree, {state.tree.root()}, state.receiver_sizes);
  for (auto _ : run)
    benchmark::DoNotOptimize(ClusterVisibility(state.tree, state.opacity, receivers));
  count_items(run, state.tree.size());
}

// One picture of all cells of the office and what is seen of each: elements.
void item_picture(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  std::vector<ElementId> cells;
  for (std::size_t i = 0; i < state.tree.initial_size(); ++i)
    if (!state.tree[ElementId(i)].is_cluster()) cells.emplace_back(i);
  for (auto _ : run)
    benchmark::DoNotOptimize(
        visible_areas(state.tree, cells, state.opacity, glm::normalize(Vec3(1, 2, 3))));
  count_items(run, cells.size());
}

// Rays from so many receivers, spread over all, to links: receivers.
void sampled_links(benchmark::State& run, int things) {
  constexpr std::size_t kReceivers = 2000;
  const SolverState& state = solved(things);
  const auto all = choose_receivers(state.tree, {state.tree.root()}, state.receiver_sizes);
  std::vector<ElementId> some;
  for (std::size_t i = 0; i < std::min(kReceivers, all.size()); ++i)
    some.push_back(all[i * all.size() / std::min(kReceivers, all.size())]);
  SampledLinkOptions options;
  options.inside = state.inside.get();
  for (auto _ : run)
    benchmark::DoNotOptimize(
        sample_links(state.tree, state.world->rays, state.opacity, some, options));
  count_items(run, some.size());
}

// Light straight from the emitters at the middles of triangles: points.
void direct_light(benchmark::State& run, int things) {
  const SolverState& state = solved(things);
  const World& world = *state.world;
  const EmitterTree emitters(*state.visibility, find_emitters(world));
  std::uint64_t k = 0;
  for (auto _ : run) {
    const TriangleId t(static_cast<std::size_t>(hash(++k, 3) % world.geometry.triangles.size()));
    const Vec3 n = glm::normalize(world.geometry.scaled_normal(t));
    const Vec3 x = world.rays.lift(world.geometry.point(t, Vec2(1.f / 3.f)), n);
    benchmark::DoNotOptimize(emitters.irradiance(x, n, {.feature_size = kFeatureSize}));
  }
  count_items(run, 1);
}

// The first level of links, from the root's link to itself: elements there are then.
void refinement(benchmark::State& run, int things) {
  const SolverState& before = solved(things);
  std::size_t elements = 0;
  for (auto _ : run) {
    run.PauseTiming();
    SolverState state = make_state(before.world, {.feature_size = kFeatureSize});
    run.ResumeTiming();
    advance(state, Progress());
    elements = state.tree.size();
  }
  count_items(run, elements);
}

// Gather, push and pull once: links.
void one_sweep(benchmark::State& run, int things) {
  SolverState state = solved(things);
  for (auto _ : run) sweep(state, 1);
  count_items(run, state.link_total());
}

// The pull alone, which a sweep does last: elements.
void pulling(benchmark::State& run, int things) {
  SolverState state = solved(things);
  for (auto _ : run) pull(state);
  count_items(run, state.tree.size());
}

// Light at the middles of triangles, with and without a gather: points.
void reading(benchmark::State& run, int things, int gather_rays) {
  const SolverState& state = solved(things);
  const Geometry& g = state.world->geometry;
  std::vector<ReadingPoint> points;
  for (std::size_t i = 0; i < 2000; ++i) {
    const TriangleId t(static_cast<std::size_t>(hash(i, 3) % g.triangles.size()));
    points.push_back({g.point(t, Vec2(1.f / 3.f)), glm::normalize(g.scaled_normal(t)), t});
  }
  ReadOptions options = kMeshReading;
  options.gather_rays = gather_rays;
  const SolutionReader reader(state, options);
  for (auto _ : run) benchmark::DoNotOptimize(reader(points));
  count_items(run, points.size());
}

void register_all() {
  const auto add = [](const std::string& name, int things, auto step) {
    benchmark::RegisterBenchmark(fmt::format("{}/{}", name, things).c_str(),
                                 [=](benchmark::State& run) { step(run, things); })
        ->UseRealTime()
        ->Unit(benchmark::kMicrosecond);
  };
  add("form_factor", 0, form_factors);
  for (const int things : kSmallThings) {
    add("surfaces", things, surfaces);
    add("live_sides", things, live_sides);
    for (const NamedHierarchy& h : kHierarchies)
      add(fmt::format("hierarchy_{}", h.name), things,
          [kind = h.kind](benchmark::State& run, int n) { hierarchy(run, n, kind); });
    add("multires_tree", things, multires_tree);
    add("blocker_sizes", things, blocker_sizes);
    add("item_picture", things, item_picture);
    add("item_buffers", things, item_buffers);
    add("transfer", things, transfers);
    add("refinement", things, refinement);
    add("sampled_links", things, sampled_links);
    add("direct_light", things, direct_light);
    add("sweep", things, one_sweep);
    add("pull", things, pulling);
    add("read_gather", things,
        [](benchmark::State& run, int n) { reading(run, n, kMeshReading.gather_rays); });
    add("read_cells", things, [](benchmark::State& run, int n) { reading(run, n, 0); });
  }
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  halflight::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
