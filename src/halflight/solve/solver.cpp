#include "halflight/solve/solver.h"

#include <chrono>

#include "halflight/base/parallel.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/solve/cells.h"
#include "halflight/solve/sweep.h"
#include "halflight/transport/emitter_tree.h"
#include "halflight/transport/outer_light.h"
#include "halflight/transport/sampled_links.h"
#include "halflight/visibility/multires_build.h"
#include "halflight/visibility/pilot.h"

namespace halflight {
namespace {

// irradiance_threshold = this * error * mean irradiance. Calibrated against the reference, see
// docs/design/refinement.md.
constexpr float kThresholdPerError = 0.02f;
constexpr float kThresholdRatio = 4.f;  // between passes
constexpr float kBlindCells = 8.f;      // RefineOptions::largest_blind_cell in feature sizes
constexpr float kClusterSizes = 1.f;    // SampledLinkOptions::largest_cluster in feature sizes
constexpr float kLeastTolerance = 0.15f;
constexpr float kSweepTolerance = 2e-4f;
constexpr int kMostSweeps = 60;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::shared_ptr<const Visibility> choose_visibility(const std::shared_ptr<const World>& world,
                                                    const Surfaces& surfaces,
                                                    const ClusterTree& clusters,
                                                    const SolveOptions& options) {
  const float s = options.feature_size;
  const bool exact = options.visibility == VisibilityMode::exact || !(s > 0.f) ||
                     (options.visibility == VisibilityMode::multires && options.visibility_pilot &&
                      !clusters_pay(measure_clutter(*world, surfaces.bodies, s)));
  if (exact) return std::make_shared<Visibility>(*world);
  // Average visibility is the hierarchy's own; multi-resolution rays may group surfaces as they
  // like.
  if (options.visibility == VisibilityMode::average)
    return std::make_shared<Visibility>(*world, surfaces, clusters, options.visibility);
  return std::make_shared<Visibility>(*world, surfaces, one_cluster(surfaces), options.visibility);
}

// Before any light has arrived: the emitted power spread over all that it could fall on.
float first_guess_of_irradiance(const SolverState& state) {
  double power = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (!state.tree[e].is_cluster() && state.tree[e].is_leaf())
      power += static_cast<double>(state.tree[e].area *
                                   average(state.exitance[e] + state.given_light[e]));
  }
  return static_cast<float>(power) / std::max(state.tree[state.tree.root()].area, 1e-30f);
}

// Errors count by the scene's mean irradiance, and a little by the receiver's own: an error that
// is nothing beside the lit part of the scene may be all that is seen in a dim room.
void update_tolerance(SolverState& state, float mean) {
  const ElementTree& tree = state.tree;
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (tree[e].is_leaf()) {
      const float share =
          tree[e].is_cluster() ? 1.f : average(state.irradiance[e]) / std::max(mean, 1e-30f);
      state.tolerance[e] = std::clamp(std::sqrt(share), kLeastTolerance, 1.f);
      continue;
    }
    float sum = 0.f, area = 0.f;
    for (const ElementId child : tree[e].children()) {
      sum += tree[child].area * state.tolerance[child];
      area += tree[child].area;
    }
    state.tolerance[e] = area > 0.f ? sum / area : 1.f;
  }
}

// Moves out of the table what the present radiosities no longer justify.
std::vector<ElementPair> take_failing_links(SolverState& state, float threshold,
                                            std::vector<ReceiverLink>& kept) {
  std::vector<ElementPair> failing;
  for (const ReceiverLink& l : state.links.release()) {
    const bool awakened = !l.link.sampled() && average(state.radiosity[l.link.source]) > 0.f;
    if (awakened || weighted_error(state.tree, l.receiver, l.link, state.radiosity) >
                        state.tolerance[l.receiver] * threshold)
      failing.push_back({l.receiver, l.link.source});
    else
      kept.push_back(l);
  }
  return failing;
}

// The elements stay; light from emitters is read exactly on each, the rest travels along rays.
std::vector<ReceiverLink> replace_by_sampled_links(SolverState& state, float threshold) {
  const EmitterTree emitters(*state.visibility, find_emitters(*state.world));
  state.emission_is_given = true;
  std::fill(state.given_light_known.begin(), state.given_light_known.end(), 0);
  SampledLinkOptions options;
  options.feature_size = state.options.feature_size;
  options.largest_cluster = kClusterSizes * state.options.feature_size;
  give_light_to_clusters(state, emitters, choose_receivers(state.tree, options.largest_cluster),
                         options);
  update_given_light(state, threshold, &emitters);
  return sample_links(state.tree, state.world->rays, state.opacity,
                      choose_receivers(state.tree, options.largest_cluster), options);
}

}  // namespace

SolverState make_state(const std::shared_ptr<const World>& world, const SolveOptions& options) {
  auto surfaces = std::make_shared<const Surfaces>(build_surfaces(world->geometry));
  const auto live = find_live_sides(world->scene, world->geometry, *surfaces, world->rays);
  const ClusterTree clusters = build_hierarchy(options.hierarchy, *surfaces);
  SolverState state{.world = world,
                    .surfaces = surfaces,
                    .tree = ElementTree(world->geometry, *surfaces, clusters, live),
                    .options = options};
  if (state.options.feature_size < 0.f)
    state.options.feature_size = world->geometry.bounds.diagonal() / 200.f;
  state.visibility = choose_visibility(world, *surfaces, clusters, state.options);

  const std::size_t n = state.tree.size();
  state.opacity.resize(n, 1.f);
  state.reflectance.resize(n);
  state.exitance.resize(n);
  state.given_light.resize(n, Rgb(0.f));
  state.given_light_known.resize(n, 0);
  if (has_outer_light(*world)) state.outer_light.resize(n, Rgb(0.f));
  state.irradiance.resize(n, Rgb(0.f));
  state.tolerance.resize(n, 1.f);
  state.radiosity.resize(n, Rgb(0.f));
  parallel_for(n, 256, [&](std::size_t i) {
    if (!state.tree[ElementId(i)].is_cluster()) evaluate_material(state, ElementId(i));
  });
  pull(state);
  return state;
}

void advance(SolverState& state, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const int pass = static_cast<int>(state.history.size());
  const auto report = [&](double share_of_pass) {
    progress.report("solve", (pass + share_of_pass) / std::max(1, state.options.passes));
  };
  report(0.0);
  const std::uint64_t rays_before = state.world->rays.ray_total();
  PassRecord record;
  const float mean = pass == 0 ? first_guess_of_irradiance(state) : mean_irradiance(state);
  record.irradiance_threshold =
      kThresholdPerError * state.options.error * mean *
      std::pow(kThresholdRatio, static_cast<float>(std::max(0, state.options.passes - 1 - pass)));

  if (pass > 0) update_tolerance(state, mean);
  update_given_light(state, record.irradiance_threshold, nullptr);
  if (pass == 0) pull(state);

  std::vector<ReceiverLink> links;
  std::vector<ElementPair> pairs;
  if (pass == 0)
    pairs.push_back({state.tree.root(), state.tree.root()});
  else
    pairs = take_failing_links(state, record.irradiance_threshold, links);
  RefineOptions refine_options;
  refine_options.irradiance_threshold = record.irradiance_threshold;
  refine_options.feature_size = state.options.feature_size;
  refine_options.smallest_cell = smallest_cell(state);
  refine_options.smallest_cluster = kClusterSizes * state.options.feature_size;
  refine_options.largest_blind_cell = 2.f * kBlindCells * smallest_cell(state);
  refine_options.most_links = state.options.most_links;
  const bool replaced =
      state.options.links == LinkMaker::sampled && pass + 1 == state.options.passes;
  refine_options.shape_only = replaced;
  RefineCounts counts;
  refine(
      state.tree, *state.visibility, state.radiosity, state.opacity, state.tolerance,
      std::move(pairs), refine_options,
      [&](const std::vector<ElementId>& split) { inherit(state, split); }, progress, links, counts);
  update_given_light(state, record.irradiance_threshold, nullptr);
  if (replaced) links = replace_by_sampled_links(state, record.irradiance_threshold);
  state.links = LinkTable(state.tree.size(), links);
  report(0.8);
  record.refine_seconds = seconds_since(start);

  record.sweeps = sweep_to_convergence(state, kSweepTolerance, kMostSweeps);
  record.sweep_seconds = seconds_since(start) - record.refine_seconds;
  record.links = state.links.size();
  record.elements = state.tree.size();
  record.pairs = counts.pairs;
  record.rays = state.world->rays.ray_total() - rays_before;
  state.history.push_back(record);
  report(1.0);
}

EnergyBalance energy_balance(const SolverState& state) {
  EnergyBalance balance;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (state.tree[e].is_cluster() || !state.tree[e].is_leaf()) continue;
    const float area = state.tree[e].area;
    balance.emitted += area * state.exitance[e];
    if (!state.outer_light.empty())
      balance.emitted += area * state.opacity[e] * state.outer_light[e];
    balance.absorbed += area * (Rgb(state.opacity[e]) - state.reflectance[e]) * state.irradiance[e];
  }
  balance.escaped = balance.emitted - balance.absorbed;
  return balance;
}

float mean_irradiance(const SolverState& state) {
  double power = 0.0, area = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    const float irradiance = average(state.irradiance[e]);
    if (state.tree[e].is_cluster() || !state.tree[e].is_leaf() || !(irradiance > 0.f)) continue;
    power += static_cast<double>(state.tree[e].area * irradiance);
    area += static_cast<double>(state.tree[e].area);
  }
  return area > 0.0 ? static_cast<float>(power / area) : 0.f;
}

}  // namespace halflight
