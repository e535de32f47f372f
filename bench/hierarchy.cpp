// Build rate of every hierarchy builder, from ten thousand to ten million surfaces.
//
//   bench_hierarchy --benchmark_filter=agglomerative
//
// Names: builder / surfaces / threads. Surfaces are small triangles in clumps of a hundred, as
// leaves of plants are. "M/s/core" are surfaces for each second of processor time, summed over
// threads; "steps" are comparisons for each surface times log2 of their number, level where the
// work grows as n log n.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/agglomerative.h"
#include "halflight/hierarchy/build_hierarchy.h"

namespace halflight {
namespace {

constexpr std::size_t kClump = 100;

const std::vector<SurfaceShape>& clumps_of_triangles(std::size_t n) {
  static std::vector<SurfaceShape> shapes;
  if (shapes.size() == n) return shapes;
  shapes.assign(n, {});
  const float room = std::cbrt(static_cast<float>(n) / static_cast<float>(kClump));
  parallel_for(n, 4096, [&](std::size_t i) {
    const auto random = [&](int k) { return to_unit_float(hash(i, k)); };
    const auto clump = [&](int k) { return to_unit_float(hash(i / kClump, k, 7)); };
    const Vec3 at =
        room * Vec3(clump(0), clump(1), clump(2)) + Vec3(random(0), random(1), random(2));
    Vec3 corner[3];
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) corner[c][k] = at[k] + 0.1f * random(3 + 3 * c + k);
    SurfaceShape& s = shapes[i];
    for (const Vec3& p : corner) s.box.extend(p);
    const Vec3 n2 = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    s.area = 0.5f * glm::length(n2);
    s.normal = n2 / std::max(2.f * s.area, 1e-20f);
    s.object = static_cast<std::uint32_t>(i / 4);
  });
  return shapes;
}

void build(benchmark::State& state, std::size_t n, int threads,
           const std::function<ClusterTree(std::span<const SurfaceShape>, std::uint64_t*)>& make) {
  const auto& shapes = clumps_of_triangles(n);
  set_thread_count(threads);
  std::uint64_t steps = 0;
  double processor_seconds = 0.0;
  for (auto _ : state) {
    steps = 0;
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    ClusterTree tree = make(shapes, &steps);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    benchmark::DoNotOptimize(tree.root);
    state.SetIterationTime(time.count());
    processor_seconds += static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  }
  set_thread_count(0);
  const auto count = static_cast<double>(n);
  state.counters["M/s/core"] =
      1e-6 * count * static_cast<double>(state.iterations()) / processor_seconds;
  state.counters["steps"] = static_cast<double>(steps) / (count * std::log2(count));
}

void register_all() {
  for (const int threads : {1, 0})
    for (const std::size_t n : {10'000u, 100'000u, 1'000'000u, 10'000'000u}) {
      const auto add = [&](std::string_view name, auto make) {
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", name, n, threads > 0 ? "1" : "all").c_str(),
            [=](benchmark::State& state) { build(state, n, threads, make); })
            ->UseManualTime()
            ->MinTime(0.2)
            ->Unit(benchmark::kMillisecond);
      };
      for (const NamedHierarchy& h : kHierarchies)
        add(h.name, [kind = h.kind](std::span<const SurfaceShape> s, std::uint64_t* steps) {
          return build_hierarchy(kind, s, steps);
        });
      add("agglomerative-radius-2", [](std::span<const SurfaceShape> s, std::uint64_t* steps) {
        AgglomerativeOptions options;
        options.search_radius = 2;
        return build_agglomerative(s, options, steps);
      });
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
