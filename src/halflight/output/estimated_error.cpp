#include "halflight/output/estimated_error.h"

#include <algorithm>
#include <cmath>

#include "halflight/base/parallel.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::size_t kProbes = 512;
// A pilot at each point says how many each of the two estimates takes there. It is no part of them:
// where it misses what is rare, they would as well.
constexpr int kPilotPaths = 64, kLeastPaths = 32, kMostPaths = 2048;
constexpr float kNoiseFloor = 0.25f;  // of the estimate, in units of the error that is aimed at

// Where somebody looks.
std::vector<ReadingPoint> scatter_over_view(const SolverState& state, std::size_t count) {
  const Geometry& g = state.world->geometry;
  std::vector<ReadingPoint> points;
  const std::size_t step = std::max<std::size_t>(1, state.seen.size() / count);
  for (std::size_t i = step / 2; i < state.seen.size(); i += step) {
    const RayHit& hit = state.seen[i];
    points.push_back({hit_position(g, hit), hit_normal(g, hit), hit.triangle});
  }
  return points;
}

// Points in gaps narrower than the feature size lie in shadows that nobody asked for.
std::vector<ReadingPoint> scatter_in_the_open(const SolverState& state, std::size_t count) {
  const RayScene& rays = state.world->rays;
  std::vector<ReadingPoint> points =
      state.seen.empty() ? scatter_points(state, count) : scatter_over_view(state, count);
  std::erase_if(points, [&](const ReadingPoint& p) {
    return rays
        .closest_hit(rays.lift(p.position, p.normal), p.normal, state.options.feature_size, 0)
        .has_value();
  });
  return points;
}

}  // namespace

std::vector<ReadingPoint> scatter_points(const SolverState& state, std::size_t count) {
  std::vector<ElementId> sides;
  std::vector<double> cumulative;
  double area = 0.0;
  for (std::size_t i = 0; i < 2 * state.surfaces->surfaces.size(); ++i) {
    const ElementId whole = state.tree.side_root(SideId(i));
    if (!whole.valid()) continue;
    sides.push_back(whole);
    cumulative.push_back(area += static_cast<double>(state.tree[whole].area));
  }
  if (sides.empty()) return {};
  std::vector<ReadingPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted =
        area * (static_cast<double>(i) + static_cast<double>(to_unit_float(hash(i, 1)))) /
        static_cast<double>(count);
    const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, wanted);
    const ElementId cell = sides[static_cast<std::size_t>(found - cumulative.begin())];
    const CellPoint at = state.tree.sample(cell, random_shift(hash(i, 2)));
    points[i] = {at.position, state.tree.normal(cell), at.triangle};
  }
  return points;
}

ErrorProbes::ErrorProbes(const SolverState& state, const Progress& progress)
    : points_(scatter_in_the_open(state, kProbes)), truths_(points_.size()) {
  const PathTracer tracer(*state.world);
  const auto trace = [&](std::size_t i, int paths, std::uint64_t estimate) {
    return tracer.estimate_irradiance(points_[i].position, points_[i].normal,
                                      static_cast<std::uint32_t>(paths), hash(i, estimate));
  };
  std::vector<float> noise(points_.size());  // of the pilots
  parallel_for(points_.size(), 4, [&](std::size_t i) {
    if (progress.cancelled()) return;
    const auto pilot = trace(i, kPilotPaths, 59);
    truths_[i] = {pilot.mean, pilot.mean};
    noise[i] = average(pilot.standard_error);
  });
  const float mean = mean_irradiance();
  // Noise of n points leaves the fourth root of its variance over n in the estimate.
  const float wanted =
      kNoiseFloor * state.options.error * std::pow(static_cast<float>(points_.size()), 0.25f);
  parallel_for(points_.size(), 1, [&](std::size_t i) {
    if (progress.cancelled()) return;
    const float scale = std::max(average(truths_[i].mean()), mean);
    const float excess = scale > 0.f ? noise[i] / (wanted * scale) : 0.f;
    const float enough = static_cast<float>(kPilotPaths) * excess * excess;
    const int paths =
        static_cast<int>(std::min(float{kMostPaths}, std::max(float{kLeastPaths}, enough)));
    truths_[i] = {trace(i, paths, 61).mean, trace(i, paths, 67).mean};
  });
}

float ErrorProbes::mean_irradiance() const {
  double sum = 0.0;
  for (const Truth& t : truths_) sum += static_cast<double>(average(t.mean()));
  return static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, truths_.size())));
}

std::optional<EstimatedError> ErrorProbes::measure(const SolverState& state,
                                                   const Progress& progress) const {
  if (progress.cancelled()) return std::nullopt;
  EstimatedError error;
  error.mean = mean_irradiance();
  if (points_.empty() || !(error.mean > 0.f)) return error;
  const std::vector<Reading> readings =
      SolutionReader(state, sensor_reading(state))(points_, progress);
  if (progress.cancelled()) return std::nullopt;
  double squares = 0.0, squared_squares = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Truth& t = truths_[i];
    const Rgb e = readings[i].irradiance();
    const float scale = std::max(average(t.mean()), error.mean);
    const auto square =
        static_cast<double>(average((e - t.first) / scale * ((e - t.second) / scale)));
    squares += square;
    squared_squares += square * square;
  }
  const auto n = static_cast<double>(points_.size());
  squares /= n;
  const double deviation = std::sqrt(std::max(0.0, squared_squares / n - squares * squares) / n);
  error.relative_rms = static_cast<float>(std::sqrt(std::max(squares, deviation)));
  error.least = static_cast<float>(std::sqrt(deviation));
  return error;
}

}  // namespace halflight
