#include "experiments/feature_study.h"

#include <chrono>
#include <ctime>

#include "halflight/features/compare.h"

namespace halflight::experiments {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StudySolution solve_and_look(const std::shared_ptr<const World>& world, const SolveOptions& options,
                             const std::vector<FlatView>& views, const ReadOptions& reading,
                             const Progress& progress) {
  StudySolution result;
  const std::uint64_t exact_before = world->rays.ray_total();
  const std::clock_t processor_start = std::clock();
  auto start = std::chrono::steady_clock::now();
  SolverState state = make_state(world, options);
  while (!state.done() && !progress.cancelled()) advance(state, progress);
  StudyCost& cost = result.cost;
  cost.seconds = seconds_since(start);
  cost.cpu_seconds = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  cost.rays = world->rays.ray_total() - exact_before + state.visibility->ray_total();
  cost.elements = state.tree.size();
  cost.links = state.link_total();
  result.feature_size = state.options.feature_size;

  start = std::chrono::steady_clock::now();
  const SolutionReader reader(state, reading);
  for (const FlatView& view : views)
    result.pictures.push_back(irradiance_picture(
        view, [&](std::span<const ReadingPoint> points) { return reader(points, progress); }));
  cost.reading_seconds = seconds_since(start);
  cost.nodes = state.visibility->node_total();
  return result;
}

StudyError judge(const FlatView& view, const Image& reference, const Image& picture,
                 const BinaryImage& shadow, float feature_size) {
  CompareOptions options;
  options.feature_sizes = {static_cast<double>(feature_size / view.pixel)};
  const Comparison c = compare(reference, picture, shadow, options);
  const FeatureError& error = c.at_sizes.front().shadows;
  const double mean = mean_of(reference);
  return {c.l2 / mean, error.value / mean, error.mask_share};
}

}  // namespace halflight::experiments
