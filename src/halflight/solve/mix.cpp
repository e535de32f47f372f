#include "halflight/solve/mix.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "halflight/base/parallel.h"
#include "halflight/solve/cells.h"
#include "halflight/solve/sweep.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 1024;

// Of each material, the group that it shines with; the number of groups: none.
IdVector<MaterialId, std::size_t> groups_of_materials(const SolverState& state) {
  const auto& groups = state.grouped.groups;
  IdVector<MaterialId, std::size_t> group(state.world->scene.materials.size(), groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const MaterialId m : groups[g].materials) group[m] = g;
  return group;
}

// Exitance of cells with each group multiplied by a factor; pull does the rest.
void set_exitance(SolverState& state, std::span<const Rgb> factors) {
  const auto group = groups_of_materials(state);
  parallel_for(state.tree.size(), kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (state.tree[e].is_cluster()) return;
    const std::size_t g = group[(*state.surfaces)[state.tree[e].side].material];
    state.exitance[e] = g < factors.size() ? factors[g] * state.grouped.exitance[e] : Rgb(0.f);
  });
}

// Light of the one group that shines in the state's world.
GroupLight light_of_one(SolverState& state) {
  const std::size_t n = state.tree.size();
  state.given_light = IdVector<ElementId, Rgb>(n, Rgb(0.f));
  state.given_light_known = IdVector<ElementId, std::uint8_t>(n, 0);
  if (!state.outer_light.empty()) state.outer_light = IdVector<ElementId, Rgb>(n, Rgb(0.f));
  state.irradiance = IdVector<ElementId, Rgb>(n, Rgb(0.f));
  pull(state);  // exitance of clusters
  if (state.emitters) {
    std::vector<ElementId> receivers = receivers_of(state, {state.tree.root()});
    std::erase_if(receivers, [&](ElementId e) { return state.sampled[e] == 0; });
    give_light_to_clusters(state, receivers, sampled_link_options(state));
  }
  update_given_light(state, kInfinity);  // splits nothing
  sweep(state);
  return {std::move(state.given_light), std::move(state.irradiance)};
}

float mean_of_leaves(const ElementTree& tree, const IdVector<ElementId, Rgb>& irradiance) {
  double power = 0.0, area = 0.0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId e(i);
    if (!tree[e].is_leaf_cell()) continue;
    power += static_cast<double>(tree[e].area * average(irradiance[e]));
    area += static_cast<double>(tree[e].area);
  }
  return area > 0.0 ? static_cast<float>(power / area) : 0.f;
}

}  // namespace

void set_groups(SolverState& state, std::vector<LightGroup> groups) {
  state.grouped.world = state.world;
  state.grouped.factors.assign(groups.size(), Rgb(1.f));
  state.grouped.groups = std::move(groups);
}

void relight(SolverState& state, std::span<const Rgb> factors) {
  const GroupedLight& grouped = state.grouped;
  const auto visibility = state.visibility;
  state.world = std::make_shared<World>(
      grouped.world, with_factors(grouped.world->scene, grouped.groups, factors));
  state.visibility = std::make_shared<Visibility>(*visibility, *state.world);
  if (state.emitters)
    state.emitters = std::make_shared<EmitterTree>(*state.visibility, find_emitters(*state.world));
}

void shine(SolverState& state, std::span<const Rgb> factors) {
  relight(state, factors);
  parallel_for(state.tree.size(), kGrain, [&](std::size_t i) {
    if (!state.tree[ElementId(i)].is_cluster()) evaluate_material(state, ElementId(i));
  });
  GroupLight light = light_of_one(state);
  state.given_light = std::move(light.given_light);
  state.irradiance = std::move(light.irradiance);
  pull(state);
  state.grouped.factors.assign(factors.begin(), factors.end());
  state.grouped.light.clear();
  state.grouped.exitance.clear();
}

void separate(SolverState& state, const Progress& progress) {
  GroupedLight& grouped = state.grouped;
  const std::size_t n = state.tree.size(), count = grouped.groups.size();
  const std::vector<Rgb> as_they_are(count, Rgb(1.f));
  relight(state, as_they_are);
  parallel_for(n, kGrain, [&](std::size_t i) {
    if (!state.tree[ElementId(i)].is_cluster()) evaluate_material(state, ElementId(i));
  });
  grouped.exitance = state.exitance;
  grouped.light.clear();
  IdVector<ElementId, float> given_share = state.given_share;  // of all groups together
  IdVector<ElementId, Rgb> outer_light(state.outer_light.size(), Rgb(0.f));
  for (std::size_t g = 0; g < count; ++g) {
    progress.report("light groups", static_cast<double>(g) / static_cast<double>(count));
    std::vector<Rgb> alone(count, Rgb(0.f));
    alone[g] = Rgb(1.f);
    relight(state, alone);
    set_exitance(state, alone);
    grouped.light.push_back(light_of_one(state));
    parallel_for(outer_light.size(), kGrain, [&](std::size_t i) {
      outer_light[ElementId(i)] += state.outer_light[ElementId(i)];
    });
  }
  state.outer_light = std::move(outer_light);
  state.given_share = std::move(given_share);
  relight(state, as_they_are);
  mix(state, as_they_are);
}

void balance(SolverState& state, const Progress& progress) {
  GroupedLight& grouped = state.grouped;
  if (grouped.groups.size() < 2) return;
  separate(state, progress);
  std::vector<float> means;
  float sum = 0.f;
  for (const GroupLight& light : grouped.light) {
    means.push_back(mean_of_leaves(state.tree, light.irradiance));
    sum += means.back();
  }
  const auto count = static_cast<float>(means.size());
  std::vector<Rgb> factors;
  for (const float mean : means)
    factors.emplace_back(mean > 0.f ? std::min(sum / (count * mean), kLargestFactor) : 1.f);
  relight(state, factors);
  mix(state, factors);
  grouped.light.clear();
  grouped.exitance.clear();
  state.options.error /= std::sqrt(count);
}

void mix(SolverState& state, std::span<const Rgb> factors) {
  GroupedLight& grouped = state.grouped;
  const std::size_t n = state.tree.size();
  state.given_light.resize(n);
  state.irradiance.resize(n);
  parallel_for(n, kGrain, [&](std::size_t i) {
    const ElementId e(i);
    Rgb given(0.f), irradiance(0.f);
    for (std::size_t g = 0; g < factors.size(); ++g) {
      given += factors[g] * grouped.light[g].given_light[e];
      irradiance += factors[g] * grouped.light[g].irradiance[e];
    }
    state.given_light[e] = given;
    state.irradiance[e] = irradiance;
  });
  set_exitance(state, factors);
  pull(state);
  grouped.factors.assign(factors.begin(), factors.end());
}

}  // namespace halflight
