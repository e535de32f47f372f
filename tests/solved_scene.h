// Scenes solved whole, and sensors scattered over them.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "halflight/output/estimated_error.h"
#include "halflight/output/read_light.h"
#include "halflight/solve/solver.h"

namespace halflight::testing {

inline SolverState solve(const std::shared_ptr<const World>& world, const SolveOptions& options) {
  SolverState state = make_state(world, options);
  const Progress progress;
  while (!state.done()) advance(state, progress);
  return state;
}

inline SolverState solve(Scene scene, const SolveOptions& options) {
  return solve(make_world(std::move(scene)), options);
}

inline SolveOptions options_of(LinkMaker links, float feature_size, float error = 0.05f) {
  SolveOptions options;
  options.links = links;
  options.feature_size = feature_size;
  options.error = error;
  return options;
}

inline std::vector<float> read_irradiance(const SolverState& state,
                                          const std::vector<ReadingPoint>& points,
                                          const ReadOptions& options = {}) {
  std::vector<float> irradiance;
  for (const Reading& reading : SolutionReader(state, options)(points))
    irradiance.push_back(average(reading.irradiance()));
  return irradiance;
}

// Area-weighted mean irradiance of the leaf cells of one side.
inline float mean_irradiance_of(const SolverState& state, SideId side) {
  double power = 0.0, area = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const Element& e = state.tree[ElementId(i)];
    if (e.side != side || !e.is_leaf()) continue;
    power += static_cast<double>(e.area * average(state.irradiance[ElementId(i)]));
    area += static_cast<double>(e.area);
  }
  return area > 0.0 ? static_cast<float>(power / area) : 0.f;
}

inline float mean(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float v : values) sum += static_cast<double>(v);
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

inline float quantile(std::vector<float> values, float share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<float>(values.size() - 1))];
}

}  // namespace halflight::testing
