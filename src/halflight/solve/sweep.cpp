#include "halflight/solve/sweep.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <utility>

#include <glm/matrix.hpp>

#include "halflight/base/parallel.h"
#include "halflight/solve/anderson.h"
#include "halflight/transport/spherical_harmonics.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr float kLargestRow = 1.3f;  // of refined links

// Below a cluster that receives by sampled links nothing has links of its own, until it is handed
// over by itself: what arrives at the cluster goes straight to its cells.
bool carries_light(const SolverState& state, ElementId e) {
  const Element& element = state.tree[e];
  return element.is_cluster() && (state.sampled[e] == 0 || !element.parent.valid() ||
                                  state.sampled[element.parent] != state.sampled[e]);
}

// Clusters that carry directional irradiance, numbered by themselves.
struct ClusterNumbers {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> of_element;
  std::size_t count = 0;

  explicit ClusterNumbers(const SolverState& state) : of_element(state.tree.initial_size(), kNone) {
    const ElementTree& tree = state.tree;
    constexpr std::size_t kBlock = 1 << 15;
    std::vector<std::uint32_t> first((tree.initial_size() + kBlock - 1) / kBlock, 0);
    const auto number_block = [&](std::size_t b, std::uint32_t next) {
      const std::size_t last = std::min(tree.initial_size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < last; ++i)
        if (carries_light(state, ElementId(i))) of_element[i] = next++;
      return next;
    };
    parallel_for(first.size(), 1, [&](std::size_t b) { first[b] = number_block(b, 0); });
    for (std::uint32_t& n : first) count += std::exchange(n, static_cast<std::uint32_t>(count));
    parallel_for(first.size(), 1, [&](std::size_t b) { number_block(b, first[b]); });
  }
  bool has(ElementId e) const { return of_element[e.value] != kNone; }
  std::uint32_t operator[](ElementId e) const { return of_element[e.value]; }
};

std::span<const Link> links_of(const SolverState& state, ElementId receiver) {
  return (state.sampled[receiver] != 0 ? state.sampled_links : state.links).of(receiver);
}

// Links to clusters of which it is known what is seen from where: each belongs to a cell of
// directions, once for sources outside the cluster and once for those inside.
class InnerLinks {
 public:
  // Of clusters whose inside is known; the span must outlive this.
  InnerLinks(const SolverState& state, std::span<const ElementId> clusters) : clusters_(clusters) {
    first_.resize(clusters.size() + 1, 0);
    for (std::size_t c = 0; c < clusters.size(); ++c)
      first_[c + 1] = first_[c] + links_of(state, clusters[c]).size();
    cell_.resize(first_.back());
    parallel_for(clusters.size(), 16, [&](std::size_t c) {
      std::size_t at = first_[c];
      for (const Link& l : links_of(state, clusters[c]))
        cell_[at++] = static_cast<std::uint8_t>(
            l.direction.all_around()
                ? kNoCell
                : direction_cell(l.direction.unpack()) +
                      (state.tree.contains(clusters[c], l.source) ? kDirectionCells : 0));
    });
  }

  // Light from each cell, as E(n) = matrix * n where it is above zero, given to the items that are
  // seen from there; from inside, to what is hidden.
  template <class Sent>
  void hand_out(SolverState& state, const Sent& sent) const {
    parallel_for(clusters_.size(), 16, [&](std::size_t c) {
      const ClusterVisibility& inside = *state.inside;
      const ElementId cluster = clusters_[c];
      std::array<glm::mat3, 2 * kDirectionCells> from;
      std::array<std::uint8_t, 2 * kDirectionCells> used{};
      std::size_t at = first_[c];
      for (const Link& l : links_of(state, cluster)) {
        const std::uint8_t cell = cell_[at++];
        if (cell == kNoCell || !l.sampled()) continue;
        if (!used[cell]) from[cell] = glm::mat3(0.f);
        used[cell] = 1;
        from[cell] += glm::outerProduct(l.weight * sent(l.source, cluster), l.direction.unpack());
      }
      std::array<int, 2 * kDirectionCells> cells;
      int count = 0;
      for (int cell = 0; cell < 2 * kDirectionCells; ++cell)
        if (used[cell]) cells[count++] = cell;
      const auto items = inside.items(cluster);
      for (std::size_t i = 0; i < items.size(); ++i) {
        Rgb sum(0.f);
        for (int k = 0; k < count; ++k) {
          const bool hidden = cells[k] >= kDirectionCells;
          const float seen =
              inside.share(cluster, i, hidden ? cells[k] - kDirectionCells : cells[k]);
          const float part = hidden ? 1.f - seen : seen;
          if (part > 0.f) sum += part * glm::max(from[cells[k]] * items[i].normal, Rgb(0.f));
        }
        state.irradiance[items[i].cell] += sum;
      }
    });
  }

 private:
  static constexpr int kNoCell = 255;
  static_assert(2 * kDirectionCells <= kNoCell);

  std::span<const ElementId> clusters_;
  std::vector<std::size_t> first_;  // of each cluster
  std::vector<std::uint8_t> cell_;  // of its links
};

// What clusters whose inside is known show of their radiosity to the receivers of their links, by
// cells of directions. Rays meet cells: only refined links have clusters for sources.
class ShownRadiosity {
 public:
  explicit ShownRadiosity(const SolverState& state) {
    if (!state.inside) return;
    wanted_.resize(state.inside->clusters().size());
    for (std::size_t i = 0; i < state.tree.size(); ++i) {
      const ElementId receiver(i);
      if (state.sampled[receiver] != 0) continue;
      for (const Link& l : state.links.of(receiver))
        if (state.inside->knows(l.source))
          wanted_[state.inside->number(l.source)][cell_of(state, l.source, receiver)] = true;
    }
    of_.resize(wanted_.size());
  }
  void update(const SolverState& state) {
    parallel_for(wanted_.size(), 64, [&](std::size_t c) {
      for (int cell = 0; cell < kDirectionCells; ++cell)
        if (wanted_[c][cell])
          of_[c][cell] =
              state.inside->seen_radiosity(state.inside->clusters()[c], cell, state.radiosity);
    });
  }
  Rgb operator()(const SolverState& state, ElementId source, ElementId receiver) const {
    // Reflected light alone; rounding must not make less than none of it.
    if (state.sampled[receiver] != 0)
      return glm::max(state.radiosity[source] - state.exitance[source], Rgb(0.f));
    if (!state.inside || !state.inside->knows(source)) return state.radiosity[source];
    return of_[state.inside->number(source)][cell_of(state, source, receiver)];
  }

 private:
  static int cell_of(const SolverState& state, ElementId source, ElementId receiver) {
    return direction_cell(state.tree[receiver].center() - state.tree[source].center());
  }

  std::vector<std::bitset<kDirectionCells>> wanted_;  // of clusters
  std::vector<std::array<Rgb, kDirectionCells>> of_;
};

// What the sweeps need beside the state, made once for all.
struct SweepPlan {
  ClusterNumbers number;
  InnerLinks inner;
  ShownRadiosity shown;
  std::vector<DirectionalIrradiance> arriving;  // at clusters

  explicit SweepPlan(const SolverState& state)
      : number(state),
        inner(state, state.inside ? state.inside->clusters() : std::span<const ElementId>()),
        shown(state),
        arriving(number.count) {}
};

bool knows_inside(const SolverState& state, ElementId e) {
  return state.inside && state.inside->knows(e);
}

// I_r = sum of weight * sent(s, r) over the links of a cell alone.
template <class Send>
Rgb gather_at_cell(const SolverState& state, ElementId r, const Send& sent) {
  Rgb sum(0.f);
  for (const Link& l : links_of(state, r))
    if (l.sampled()) sum += l.weight * sent(l.source, r);
  return sum;
}

// The same of a cluster. Those whose inside is known hand theirs out at once, but for light from
// all around.
template <class Send>
DirectionalIrradiance gather_at_cluster(const SolverState& state, ElementId r, const Send& sent) {
  const bool known = knows_inside(state, r);
  DirectionalIrradiance sum;
  for (const Link& l : links_of(state, r)) {
    if (!l.sampled()) continue;
    if (l.direction.all_around())
      sum.add_isotropic(l.weight * sent(l.source, r));
    else if (!known)
      sum.add(l.direction.unpack(), l.weight * sent(l.source, r));
  }
  return sum;
}

template <class Send>
void gather(SolverState& state, SweepPlan& plan, const Send& sent) {
  const ElementTree& tree = state.tree;
  parallel_for(tree.size(), kGrain, [&](std::size_t i) {
    const ElementId r(i);
    if (!tree[r].is_cluster())
      state.irradiance[r] = gather_at_cell(state, r, sent);
    else if (plan.number.has(r))
      plan.arriving[plan.number[r]] = gather_at_cluster(state, r, sent);
  });
  plan.inner.hand_out(state, sent);
}

template <class Visit>
void for_level(const ElementTree& tree, std::size_t depth, const Visit& visit) {
  const IdRange<ElementId> level = tree.level(depth);
  parallel_for(level.size(), kGrain, [&](std::size_t i) { visit(level[i]); });
}

// From each cell to its parts.
void push_down(SolverState& state, ElementId cell) {
  for (const ElementId part : state.tree[cell].children()) {
    if (state.sampled[part] == state.sampled[cell])
      state.irradiance[part] += state.irradiance[cell];
    push_down(state, part);
  }
}

// From a cluster to the whole sides that it lights as one.
void push_below(SolverState& state, ElementId cluster, const DirectionalIrradiance& arriving) {
  for (const ElementId child : state.tree[cluster].children()) {
    if (state.sampled[child] != state.sampled[cluster]) continue;
    if (state.tree[child].is_cluster())
      push_below(state, child, arriving);
    else
      state.irradiance[child] += arriving.irradiance(state.tree.normal(child));
  }
}

// Hands everything down: all but to receivers whose sampled links bring the whole light.
void push(SolverState& state, SweepPlan& plan) {
  const ElementTree& tree = state.tree;
  for (std::size_t depth = 0; depth < tree.depth(); ++depth)
    for_level(tree, depth, [&](ElementId e) {
      if (!tree[e].is_cluster()) return push_down(state, e);
      if (!plan.number.has(e)) return;
      const DirectionalIrradiance& arriving = plan.arriving[plan.number[e]];
      if (!arriving.any()) return;
      if (state.sampled[e] != 0) return push_below(state, e, arriving);
      for (const ElementId child : tree[e].children()) {
        if (state.sampled[child] != state.sampled[e]) continue;
        if (tree[child].is_cluster())
          plan.arriving[plan.number[child]] += arriving;
        else
          state.irradiance[child] += arriving.irradiance(tree.normal(child));
      }
    });
}

// By what the light that links bring to a leaf is multiplied, so that surroundings of radiosity 1
// (translucent ones: of their opacity) bring at most kLargestRow, 1 for sampled links. Weights are
// estimated one by one, and those of a nook may add up to much more than 1: pale surfaces there
// would feed each other without end. Sums a little above 1 are noise, and cutting only those would
// lose energy. Above 1 / reflectance a cell would send more than came from all around it.
float row_limit(const SolverState& state, ElementId e) {
  const float reflected = std::max(max_component(state.reflectance[e]), 1e-6f);
  const float largest = state.sampled[e] != 0 ? 1.f : std::clamp(1.f / reflected, 1.f, kLargestRow);
  return std::min(1.f, largest / std::max(state.irradiance[e].r, 1e-6f));
}

IdVector<ElementId, float> find_row_limits(SolverState& state, SweepPlan& plan) {
  gather(state, plan, [&](ElementId s, ElementId) { return Rgb(state.opacity[s]); });
  push(state, plan);
  IdVector<ElementId, float> limits(state.tree.size());
  parallel_for(limits.size(), kGrain,
               [&](std::size_t i) { limits[ElementId(i)] = row_limit(state, ElementId(i)); });
  return limits;
}

template <class Visit>
void for_all_cells_below(const ElementTree& tree, ElementId top, const Visit& visit) {
  for_all_below(tree, top, [&](ElementId e) {
    if (!tree[e].is_cluster()) visit(e);
  });
}

// Adds what arrives by no link to the limited light of the links.
void finish_leaves(SolverState& state) {
  parallel_for(state.tree.size(), kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (state.tree[e].is_leaf_cell())
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
Change change_by_pull(const SolverState& state) {
  return parallel_sum(state.tree.size(), kGrain, Change{}, [&](std::size_t i) {
    const ElementId id(i);
    const Element& e = state.tree[id];
    if (!e.is_leaf_cell()) return Change{};
    const Rgb reflected = state.reflectance[id] * state.irradiance[id];
    return Change{e.area * average(glm::abs(change_of_radiosity(state, id))),
                  e.area * average(reflected)};
  });
}

void set_mean_of_children(SolverState& state, ElementId e) {
  const ElementTree& tree = state.tree;
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

void pull_up(SolverState& state, ElementId cell) {
  if (state.tree[cell].is_leaf()) {
    state.radiosity[cell] = state.exitance[cell] + state.reflectance[cell] * state.irradiance[cell];
    return;
  }
  for (const ElementId part : state.tree[cell].children()) pull_up(state, part);
  set_mean_of_children(state, cell);
}

}  // namespace

void pull(SolverState& state) {
  const ElementTree& tree = state.tree;
  for (std::size_t depth = tree.depth(); depth-- > 0;)
    for_level(tree, depth, [&](ElementId e) {
      tree[e].is_cluster() ? set_mean_of_children(state, e) : pull_up(state, e);
    });
}

void update_row_limits(SolverState& state, std::span<const ElementId> receivers) {
  if (state.row_limits.empty()) return;
  const ElementTree& tree = state.tree;
  const auto sent = [&](ElementId s, ElementId) { return Rgb(state.opacity[s]); };
  std::vector<ElementId> known;
  for (const ElementId r : receivers)
    if (knows_inside(state, r)) known.push_back(r);
  const auto for_receivers = [&](const auto& act) {
    parallel_for(receivers.size(), 16, [&](std::size_t i) { act(receivers[i]); });
  };
  for_receivers([&](ElementId r) {
    for_all_cells_below(tree, r, [&](ElementId e) { state.irradiance[e] = Rgb(0.f); });
  });
  InnerLinks(state, known).hand_out(state, sent);
  for_receivers([&](ElementId r) {
    if (tree[r].is_cluster())
      push_below(state, r, gather_at_cluster(state, r, sent));
    else
      state.irradiance[r] += gather_at_cell(state, r, sent);
    for_all_cells_below(tree, r, [&](ElementId e) {
      if (tree[tree[e].parent].is_cluster()) push_down(state, e);
    });
    for_all_cells_below(tree, r, [&](ElementId e) { state.row_limits[e] = row_limit(state, e); });
  });
}

Sweeps sweep(SolverState& state, int most_sweeps, double largest_change) {
  SweepPlan plan(state);
  if (state.row_limits.size() != state.tree.size()) state.row_limits = find_row_limits(state, plan);
  AndersonMixing acceleration;
  // It takes four vectors of all elements, and a first sweep has nothing to be mixed with.
  const bool accelerated = state.options.memory == 0 && most_sweeps > 1;
  Sweeps done;
  while (done.count < most_sweeps && !done.converged) {
    plan.shown.update(state);
    gather(state, plan, [&](ElementId s, ElementId r) { return plan.shown(state, s, r); });
    push(state, plan);
    finish_leaves(state);
    const Change change = change_by_pull(state);
    done.converged = !(change.absolute > largest_change * change.reflected);
    if (accelerated && !done.converged) acceleration.mix(state);
    pull(state);
    ++done.count;
  }
  return done;
}

}  // namespace halflight
