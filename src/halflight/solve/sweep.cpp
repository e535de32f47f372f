#include "halflight/solve/sweep.h"

#include "halflight/base/parallel.h"
#include "halflight/transport/spherical_harmonics.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr float kLargestRow = 1.3f;  // of refined links

// Clusters numbered by themselves, so that only they carry directional irradiance.
struct ClusterNumbers {
  std::vector<std::uint32_t> of_element;
  std::size_t count = 0;

  explicit ClusterNumbers(const ElementTree& tree) : of_element(tree.initial_size()) {
    for (std::size_t i = 0; i < tree.initial_size(); ++i)
      if (tree[ElementId(i)].is_cluster()) of_element[i] = static_cast<std::uint32_t>(count++);
  }
  std::uint32_t operator[](ElementId e) const { return of_element[e.value]; }
};

// What an element sends along a link: everything, or along sampled links what it reflects.
struct Sent {
  const IdVector<ElementId, Rgb>& radiosity;
  const IdVector<ElementId, Rgb>& exitance;
  Rgb operator()(ElementId s, bool sampled) const {
    return sampled ? radiosity[s] - exitance[s] : radiosity[s];
  }
};

// I_r = sum of weight * sent(s) over the links of each element alone.
template <class Send>
void gather(SolverState& state, const ClusterNumbers& number,
            std::vector<DirectionalIrradiance>& arriving, const Send& sent) {
  const ElementTree& tree = state.tree;
  parallel_for(tree.size(), kGrain, [&](std::size_t i) {
    const ElementId r(i);
    const bool sampled = state.sampled[r] != 0;
    const std::span<const Link> links = (sampled ? state.sampled_links : state.links).of(r);
    if (tree[r].is_cluster()) {
      DirectionalIrradiance& sum = arriving[number[r]];
      sum = {};
      for (const Link& l : links) {
        if (!l.sampled()) continue;
        const Rgb e = l.weight * sent(l.source, sampled);
        if (l.direction.all_around())
          sum.add_isotropic(e);
        else
          sum.add(l.direction.unpack(), e);
      }
      return;
    }
    Rgb sum(0.f);
    for (const Link& l : links)
      if (l.sampled()) sum += l.weight * sent(l.source, sampled);
    state.irradiance[r] = sum;
  });
}

// Parents come before their children, so one pass in id order hands everything down: all but to
// receivers whose sampled links bring the whole light.
void push(SolverState& state, const ClusterNumbers& number,
          std::vector<DirectionalIrradiance>& arriving) {
  const ElementTree& tree = state.tree;
  const std::size_t top = tree.initial_size();
  const auto inherits = [&](ElementId e) {
    return state.sampled[e] == state.sampled[tree[e].parent];
  };
  for (std::size_t i = 1; i < top; ++i) {
    const ElementId e(i);
    if (tree[e].is_cluster() && inherits(e))
      arriving[number[e]] += arriving[number[tree[e].parent]];
  }
  parallel_for(top, kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (!tree[e].is_cluster() && inherits(e))
      state.irradiance[e] += arriving[number[tree[e].parent]].irradiance(tree.normal(e));
  });
  for (std::size_t i = top; i < tree.size(); ++i)
    if (inherits(ElementId(i)))
      state.irradiance[ElementId(i)] += state.irradiance[tree[ElementId(i)].parent];
}

// By what the light that links bring to a leaf is multiplied, so that surroundings of radiosity 1
// (translucent ones: of their opacity) bring at most kLargestRow, 1 for sampled links. Weights are
// estimated one by one, and those of a nook may add up to much more than 1: pale surfaces there
// would feed each other without end. Sums a little above 1 are noise, and cutting only those would
// lose energy.
IdVector<ElementId, float> find_row_limits(SolverState& state, const ClusterNumbers& number,
                                           std::vector<DirectionalIrradiance>& arriving) {
  gather(state, number, arriving, [&](ElementId s, bool) { return Rgb(state.opacity[s]); });
  push(state, number, arriving);
  IdVector<ElementId, float> limits(state.tree.size());
  parallel_for(limits.size(), kGrain, [&](std::size_t i) {
    const ElementId e(i);
    const float largest = state.sampled[e] != 0 ? 1.f : kLargestRow;
    limits[e] = std::min(1.f, largest / std::max(state.irradiance[e].r, 1e-6f));
  });
  return limits;
}

// Adds what arrives by no link to the limited light of the links.
void finish_leaves(SolverState& state) {
  parallel_for(state.tree.size(), kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (!state.tree[e].is_cluster() && state.tree[e].is_leaf())
      state.irradiance[e] = state.row_limits[e] * state.irradiance[e] + state.given_light[e];
  });
}

// Power that the next pull adds or removes, and all that is reflected. Not the change of the sum:
// on the way from one set of links to another, what one place gains another may lose.
struct Change {
  double absolute = 0.0, reflected = 0.0;
  Change& operator+=(const Change& c) {
    absolute += c.absolute;
    reflected += c.reflected;
    return *this;
  }
};
Change change_of_radiosity(const SolverState& state) {
  return parallel_sum(state.tree.size(), kGrain, Change{}, [&](std::size_t i) {
    const ElementId id(i);
    const Element& e = state.tree[id];
    if (e.is_cluster() || !e.is_leaf()) return Change{};
    const Rgb reflected = state.reflectance[id] * state.irradiance[id];
    const Rgb change = state.exitance[id] + reflected - state.radiosity[id];
    return Change{e.area * average(glm::abs(change)), e.area * average(reflected)};
  });
}

}  // namespace

void pull(SolverState& state) {
  const ElementTree& tree = state.tree;
  parallel_for(tree.size(), kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (!tree[e].is_cluster() && tree[e].is_leaf())
      state.radiosity[e] = state.exitance[e] + state.reflectance[e] * state.irradiance[e];
  });
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (tree[e].is_leaf()) continue;
    Rgb power(0.f), emitted(0.f);
    float area = 0.f;
    for (const ElementId child : tree[e].children()) {
      power += tree[child].area * state.radiosity[child];
      emitted += tree[child].area * state.exitance[child];
      area += tree[child].area;
    }
    state.radiosity[e] = power / std::max(area, 1e-30f);
    state.exitance[e] = emitted / std::max(area, 1e-30f);
  }
}

Sweeps sweep(SolverState& state, float tolerance, int most_sweeps) {
  const ClusterNumbers number(state.tree);
  std::vector<DirectionalIrradiance> arriving(number.count);
  if (state.row_limits.empty()) state.row_limits = find_row_limits(state, number, arriving);
  Sweeps done;
  while (done.count < most_sweeps && !done.converged) {
    gather(state, number, arriving, Sent{state.radiosity, state.exitance});
    push(state, number, arriving);
    finish_leaves(state);
    const Change change = change_of_radiosity(state);
    pull(state);
    ++done.count;
    done.converged = change.absolute <= static_cast<double>(tolerance) * change.reflected;
  }
  return done;
}

}  // namespace halflight
