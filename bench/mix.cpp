// Mixes of light groups a second: the weighted sum over all elements and the pull of radiosity.
//
//   bench_mix --benchmark_filter=8
//
// Names: groups / elements.
#include <benchmark/benchmark.h>

#include <fmt/format.h>

#include "halflight/base/hash.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/solve/mix.h"

namespace halflight {
namespace {

// Cells split until there are enough; how they came about does not matter here, nor does the light.
SolverState split_up(std::size_t elements, std::size_t groups) {
  SolveOptions options;
  options.feature_size = 0.05f;
  SolverState state = make_state(make_world(office_scene({100, 1})), options);
  for (std::size_t i = 0; state.tree.size() < elements; ++i)
    if (const ElementId e(i); state.tree[e].is_leaf_cell()) state.tree.split(e);
  const std::size_t n = state.tree.size();
  state.reflectance = IdVector<ElementId, Rgb>(n, Rgb(0.5f));
  state.exitance.resize(n);
  state.radiosity.resize(n);
  GroupedLight& grouped = state.grouped;
  grouped.groups.resize(groups);
  grouped.exitance = IdVector<ElementId, Rgb>(n, Rgb(0.f));
  for (std::size_t g = 0; g < groups; ++g) {
    GroupLight light{IdVector<ElementId, Rgb>(n), IdVector<ElementId, Rgb>(n)};
    for (std::size_t i = 0; i < n; ++i)
      light.irradiance[ElementId(i)] = Rgb(to_unit_float(hash(g, i)));
    grouped.light.push_back(std::move(light));
  }
  return state;
}

void mix_groups(benchmark::State& run, std::size_t groups, std::size_t elements) {
  SolverState state = split_up(elements, groups);
  float dimmed = 1.f;
  for (auto _ : run) {
    dimmed *= 0.999f;
    mix(state, std::vector<Rgb>(groups, Rgb(dimmed)));
    benchmark::DoNotOptimize(state.radiosity[state.tree.root()]);
  }
  run.counters["mixes/s"] =
      benchmark::Counter(static_cast<double>(run.iterations()), benchmark::Counter::kIsRate);
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  for (const std::size_t groups : {2, 8, 32})
    for (const std::size_t elements : {100'000, 1'000'000})
      benchmark::RegisterBenchmark(
          fmt::format("mix/{}/{}", groups, elements).c_str(),
          [=](benchmark::State& run) { halflight::mix_groups(run, groups, elements); })
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
