#include "halflight/solve/solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/solve/cells.h"
#include "halflight/solve/importance.h"
#include "halflight/solve/memory.h"
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
constexpr float kThresholdRatio = 4.f;  // between levels
constexpr float kFeatureRatio = 2.f;    // of feature sizes
// Of the first iteration to the first level, when iterations are to be short.
constexpr float kFirstThreshold = 16.f;
constexpr float kFirstError = 1.f;              // that a coarse beginning aims at
constexpr std::size_t kCoarseReceivers = 8192;  // at most, but for emitters and cells
constexpr std::size_t kManyElements = 200'000;  // that get sampled links before refined ones
constexpr std::size_t kCellsOfFirstGuess = 512;
constexpr double kShareOfCoarse = 0.1;  // of the work, roughly
constexpr float kBlindCells = 8.f;      // RefineOptions::largest_blind_cell in feature sizes
constexpr float kLeastTolerance = 0.15f;
constexpr int kSweepsOfShortIteration = 2;
constexpr int kSweepsOfFirstResult = 4;          // a few bounces
constexpr int kMostSweepsOfShortIteration = 16;  // where nothing but sweeps is left to do
constexpr double kLittleChangeForNow = 0.005;    // where finer links are to come
constexpr double kFinePartsOfElement = 3e-6;     // seconds, before it is known
constexpr int kFirstGuessOfSweeps = 10;
constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
constexpr float kFewestRays = 6.f;  // of a cell; its refined links serve better
constexpr std::size_t kReceiversAtOnce = 1 << 14;
constexpr std::size_t kReceiversAtOnceInLittleMemory = 1 << 11;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::shared_ptr<const Visibility> choose_visibility(const std::shared_ptr<const World>& world,
                                                    const Surfaces& surfaces,
                                                    const ClusterTree* clusters,
                                                    const SolveOptions& options) {
  const float s = options.feature_size;
  const bool exact = options.visibility == VisibilityMode::exact || !(s > 0.f) ||
                     (options.visibility == VisibilityMode::multires && options.visibility_pilot &&
                      !clusters_pay(measure_clutter(*world, surfaces.bodies, s)));
  if (exact) return std::make_shared<Visibility>(*world);
  // Average visibility is the hierarchy's own; multi-resolution rays may group surfaces as they
  // like.
  if (options.visibility == VisibilityMode::average)
    return std::make_shared<Visibility>(*world, surfaces, *clusters, options.visibility);
  return std::make_shared<Visibility>(*world, surfaces, one_cluster(surfaces), options.visibility);
}

// An emitter lies nearer to the cluster than the cluster is large.
bool is_near_emitter(const SolverState& state, ElementId cluster) {
  const ElementTree& tree = state.tree;
  const Bounds3f& box = tree[cluster].box;
  const float reach = tree[cluster].diameter();
  std::vector<ElementId> open{tree.root()};
  while (!open.empty()) {
    const ElementId e = open.back();
    open.pop_back();
    if (!(max_component(state.exitance[e]) > 0.f)) continue;
    const Bounds3f& other = tree[e].box;
    const Vec3 gap = glm::max(glm::max(box.lower - other.upper, other.lower - box.upper), 0.f);
    if (glm::dot(gap, gap) > reach * reach) continue;
    if (tree[e].is_leaf()) return true;
    for (const ElementId child : tree[e].children()) open.push_back(child);
  }
  return false;
}

IdVector<ElementId, float> receiver_sizes(const SolverState& state) {
  IdVector<ElementId, float> sizes = state.feature_sizes;
  parallel_for(sizes.size(), 256, [&](std::size_t i) {
    const ElementId e(i);
    if (state.tree[e].is_cluster() && state.tree[e].diameter() <= sizes[e] &&
        is_near_emitter(state, e))
      sizes[e] = 0.f;
  });
  return sizes;
}

// Before any light has arrived: the emitted power spread over all that it could fall on.
float first_guess_of_irradiance(const SolverState& state) {
  double emitted = 0.0, given = 0.0, known = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) continue;
    const auto area = static_cast<double>(state.tree[e].area);
    emitted += area * static_cast<double>(average(state.exitance[e]));
    if (!state.given_light_known[e]) continue;
    known += area;
    given += area * static_cast<double>(average(state.given_light[e]));
  }
  const auto all = static_cast<double>(std::max(state.tree[state.tree.root()].area, 1e-30f));
  return static_cast<float>(emitted / all + (known > 0.0 ? given / known : 0.0));
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

// What matters less to the view may be further off.
void weigh_by_importance(SolverState& state) {
  state.importance = solve_importance(state, state.seen);
  for (std::size_t i = 0; i < state.tree.size(); ++i)
    state.tolerance[ElementId(i)] /= std::sqrt(state.importance[ElementId(i)]);
}

// Levels whose links are refined; with sampled links the last one only shapes elements.
int levels_of_links(const SolveOptions& options) {
  return options.levels - (options.links == LinkMaker::sampled ? 1 : 0);
}

// Until threshold and feature sizes are those asked for.
int levels_left(const SolverState& state) {
  return std::max(0, state.options.levels - 1 - state.schedule.level);
}

// Light that no link brings, before the first one: on all leaf cells, or only on some of them where
// sampling begins at once.
void begin_given_light(SolverState& state) {
  if (state.schedule.stage != Stage::sample) return update_given_light(state, kInfinity);
  std::vector<ElementId> some;
  for (std::size_t k = 0; k < kCellsOfFirstGuess; ++k) {
    const ElementId e(hash(k) % state.tree.size());
    if (state.tree[e].is_leaf_cell()) some.push_back(e);
  }
  std::sort(some.begin(), some.end());
  some.erase(std::unique(some.begin(), some.end()), some.end());
  update_given_light(state, kInfinity, some, 0.0);
}

// Of what is emitted: where it all gets lost there still is a threshold, else refinement never
// ends.
constexpr float kLeastShareOfGuess = 1e-6f;

// Threshold and tolerances of the level that comes next, by the light that is there now.
void begin_level(SolverState& state) {
  float mean = 0.f;
  if (state.history.empty()) {
    begin_given_light(state);
    mean = first_guess_of_irradiance(state);
    pull(state);
  } else {
    mean = std::max(mean_irradiance(state), kLeastShareOfGuess * first_guess_of_irradiance(state));
    update_tolerance(state, mean);
    if (state.options.importance) weigh_by_importance(state);
  }
  state.schedule.irradiance_threshold =
      kThresholdPerError * aimed_error(state) * mean *
      std::pow(kThresholdRatio, static_cast<float>(levels_left(state)));
}

// Error of a link in units of what its receiver tolerates at this level. Links whose source was
// dark until now have to be sampled in any case.
float relative_error(const SolverState& state, const ReceiverLink& l) {
  const float tolerated = state.tolerance[l.receiver] * state.schedule.irradiance_threshold;
  const float error =
      weighted_error(state.tree, state.inside.get(), l.receiver, l.link, state.radiosity) /
      std::max(tolerated, 1e-30f);
  const bool awakened = !l.link.sampled() && average(state.radiosity[l.link.source]) > 0.f;
  return awakened ? std::max(error, std::nextafter(1.f, 2.f)) : error;
}

struct WorstLinks {
  std::vector<ReceiverLink> links;  // in receiver order
  std::vector<ReceiverLink> others;
  float threshold = 1.f;  // above which they lie, relative to the level's
  bool all = true;        // that lie above it
};

// The k links of the largest errors above the level's threshold, to within a bin of the histogram.
WorstLinks find_worst_links(const SolverState& state, const std::vector<ReceiverLink>& links,
                            std::size_t k) {
  std::vector<float> errors(links.size());
  parallel_for(links.size(), 4096,
               [&](std::size_t i) { errors[i] = relative_error(state, links[i]); });
  ErrorHistogram histogram;
  for (const float e : errors)
    if (e > 1.f) histogram.add(e);
  WorstLinks worst;
  worst.threshold = histogram.threshold_for(k);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const bool above = errors[i] > worst.threshold;
    if (above && worst.links.size() == k) worst.all = false;
    (above && worst.all ? worst.links : worst.others).push_back(links[i]);
  }
  return worst;
}

std::vector<ElementPair> pairs_of(const std::vector<ReceiverLink>& links) {
  std::vector<ElementPair> pairs(links.size());
  for (std::size_t i = 0; i < links.size(); ++i)
    pairs[i] = {links[i].receiver, links[i].link.source};
  return pairs;
}

// Of the links that do not hold at this level.
std::vector<ElementPair> failing_pairs(const SolverState& state) {
  return parallel_collect<ElementPair>(state.tree.size(), 1024,
                                       [&](std::size_t i, std::vector<ElementPair>& pairs) {
                                         const ElementId receiver(i);
                                         for (const Link& link : state.links.of(receiver))
                                           if (relative_error(state, {receiver, link}) > 1.f)
                                             pairs.push_back({receiver, link.source});
                                       });
}

// Any part of the list is then like the whole, and its time tells that of the others; neighbours,
// whose rays meet the same places, stay together.
template <class T>
void shuffle_blocks(std::vector<T>& list) {
  constexpr std::size_t kBlock = 64;
  std::vector<std::size_t> blocks((list.size() + kBlock - 1) / kBlock);
  std::iota(blocks.begin(), blocks.end(), std::size_t{0});
  std::sort(blocks.begin(), blocks.end(),
            [](std::size_t a, std::size_t b) { return mix_bits(a) < mix_bits(b); });
  std::vector<T> shuffled;
  shuffled.reserve(list.size());
  for (const std::size_t b : blocks) {
    const auto at = [&](std::size_t i) {
      return list.begin() + static_cast<std::ptrdiff_t>(std::min(list.size(), i));
    };
    shuffled.insert(shuffled.end(), at(b * kBlock), at((b + 1) * kBlock));
  }
  list = std::move(shuffled);
}

// Appends the links that come of the pairs, none when only the shape of elements is wanted.
void refine_pairs(SolverState& state, std::vector<ElementPair> pairs, bool shape_only,
                  const Progress& progress, std::vector<ReceiverLink>& links,
                  IterationRecord& record) {
  RefineOptions options;
  options.irradiance_threshold = record.irradiance_threshold;
  options.feature_sizes = &state.feature_sizes;
  options.feature_scale = std::pow(kFeatureRatio, static_cast<float>(levels_left(state)));
  options.finest_cell = finest_cell(state);
  options.largest_blind_cell = 2.f * kBlindCells;
  const MemoryRoom room = memory_room(state);
  options.most_links = std::min(state.options.most_links, room.refined_links);
  options.most_elements = room.elements;
  options.shape_only = shape_only;
  options.inside = state.inside.get();
  record.refined = pairs.size();
  RefineCounts counts;
  refine(
      state.tree, *state.visibility, state.radiosity, state.opacity, state.tolerance,
      std::move(pairs), options,
      [&](const std::vector<ElementId>& split) { inherit(state, split); }, progress, links, counts);
  record.pairs = counts.pairs;
  if (counts.accepted_early > 0 && state.options.memory > 0 && !progress.cancelled())
    state.schedule.short_of_memory = 1;
  update_given_light(state, record.irradiance_threshold);
}

// Refines the k worst links; ends the level when there are no more.
void refine_links(SolverState& state, std::size_t k, const Progress& progress,
                  IterationRecord& record) {
  Schedule& todo = state.schedule;
  std::vector<ReceiverLink> links;
  bool level_done = true;
  if (todo.pairs.empty()) {
    WorstLinks worst = find_worst_links(state, state.links.release(), k);
    todo.pairs = pairs_of(worst.links);
    links = std::move(worst.others);
    record.irradiance_threshold *= worst.threshold;
    level_done = worst.all && worst.threshold == 1.f;
  } else if (k < kUnlimited) {
    record.irradiance_threshold *= kFirstThreshold;
    level_done = false;
  }
  refine_pairs(state, std::exchange(todo.pairs, {}), false, progress, links, record);
  state.links.append(links);
  if (!level_done) return;
  todo.irradiance_threshold = 0.f;
  if (++todo.level < levels_of_links(state.options)) return;
  todo.stage = state.options.links == LinkMaker::sampled ? Stage::shape : Stage::converge;
  // These were only for the elements that are to come.
  if (todo.coarseness > 1.f && todo.round > 0) todo.coarseness = 1.f;
}

// Elements for the last level, by k of the links that would not hold there.
void shape_elements(SolverState& state, std::size_t k, const Progress& progress,
                    IterationRecord& record) {
  Schedule& todo = state.schedule;
  const std::size_t n = std::min(k, todo.pairs.size());
  const auto last = todo.pairs.end();
  std::vector<ElementPair> pairs(last - static_cast<std::ptrdiff_t>(n), last);
  todo.pairs.resize(todo.pairs.size() - n);
  std::vector<ReceiverLink> none;
  refine_pairs(state, std::move(pairs), true, progress, none, record);
  if (todo.pairs.empty()) todo.stage = Stage::sample;
}

// From now on these elements and all below them receive by sampled links, and light from emitters
// is read exactly on each.
void hand_over(SolverState& state, const std::vector<ElementId>& receivers) {
  parallel_for(receivers.size(), 64, [&](std::size_t i) {
    for_all_below(state.tree, receivers[i], [&](ElementId e) {
      state.sampled[e] = state.schedule.round;
      state.given_light_known[e] = 0;
    });
  });
  if (state.sampled_links.size() == 0) return;
  for (const ElementId receiver : receivers)
    for_all_below(state.tree, receiver, [&](ElementId e) { state.sampled_links.clear(e); });
}

// How far the schedule has got: most of the time goes into sampled links.
double share_done(const SolverState& state) {
  const Schedule& todo = state.schedule;
  if (todo.coarseness > 1.f) return todo.stage == Stage::sample ? kShareOfCoarse : 0.0;
  const bool samples = state.options.links == LinkMaker::sampled;
  const double of_refinement = samples ? 0.3 : 1.0;
  switch (todo.stage) {
    case Stage::refine:
    case Stage::shape:
      return of_refinement * todo.level / std::max(1, state.options.levels);
    case Stage::sample: {
      const auto left = static_cast<double>(todo.receivers.size());
      const auto total = static_cast<double>(std::max<std::size_t>(1, todo.receiver_total));
      return of_refinement + (0.95 - of_refinement) * (1.0 - left / total);
    }
    case Stage::converge:
      return 0.95;
    case Stage::done:
      break;
  }
  return 1.0;
}

// Fewer rays where the links of what receives below these roots and of all that still wait would
// not fit into memory; 0 where next to none do.
float share_of_rays_within(const SolverState& state, const std::vector<ElementId>& roots,
                           const SampledLinkOptions& options) {
  if (state.options.memory == 0) return 1.f;
  double wanted = 0.0;
  for (const ElementId e : receivers_of(state, roots)) wanted += rays_of(state.tree, e, options);
  const auto waiting = static_cast<double>(roots.size() + state.schedule.receivers.size());
  wanted *= waiting / static_cast<double>(std::max<std::size_t>(1, roots.size()));
  const auto room = static_cast<double>(memory_room(state).sampled_links);
  return wanted > room ? static_cast<float>(room / wanted) : 1.f;
}

// Gives sampled links to the next k receivers; `power`: received by all so far.
void sample_receivers(SolverState& state, std::size_t k, double power, IterationRecord& record) {
  std::vector<ElementId>& waiting = state.schedule.receivers;
  const auto first = waiting.end() - static_cast<std::ptrdiff_t>(std::min(k, waiting.size()));
  const std::vector<ElementId> receivers(first, waiting.end());
  waiting.erase(first, waiting.end());
  SampledLinkOptions options = sampled_link_options(state, power);
  const float share = share_of_rays_within(state, receivers, options);
  if (share < 1.f) {
    state.schedule.short_of_memory = 1;
    // Fewer rays than in the round before would be no gain.
    if (state.schedule.round > 1 ||
        share * static_cast<float>(options.rays_per_cell) < kFewestRays) {
      waiting.clear();
      return;
    }
    options.rays_per_cell = static_cast<int>(share * static_cast<float>(options.rays_per_cell));
    options.rays_per_cluster =
        static_cast<int>(share * static_cast<float>(options.rays_per_cluster));
  }
  hand_over(state, receivers);
  give_light_to_clusters(state, receivers, options);
  update_given_light(state, record.irradiance_threshold, receivers, power);
  const std::vector<ElementId> leaves = receivers_of(state, receivers);
  state.sampled_links.append(
      sample_links(state.tree, state.world->rays, state.opacity, leaves, options));
  update_row_limits(state, leaves);
  record.refined += receivers.size();
}

// Cells that were split since an earlier round have kept their links for those of their parts that
// had none of their own yet.
void forget_earlier_rounds(SolverState& state) {
  // What does not matter to the view has no part in later rounds.
  if (!state.importance.empty()) return;
  for (std::size_t i = 0; i < state.tree.size(); ++i)
    if (state.sampled[ElementId(i)] != state.schedule.round)
      state.sampled_links.clear(ElementId(i));
  const std::vector<ReceiverLink> links = state.sampled_links.release();
  state.sampled_links.append(links);
}

// For a smaller error than that of the links there are.
void begin_finer_links(SolverState& state) {
  state.schedule.irradiance_threshold = 0.f;
  state.schedule.level = levels_of_links(state.options);
  state.schedule.stage = state.options.links == LinkMaker::sampled ? Stage::shape : Stage::refine;
}

// To the solution that is asked for: refined links tell which elements it needs, those of a coarse
// solution do.
void go_on_from_coarse(SolverState& state) {
  Schedule& todo = state.schedule;
  if (state.links.size() > 0 || levels_of_links(state.options) == 0) {
    todo.coarseness = 1.f;
    return begin_finer_links(state);
  }
  todo.irradiance_threshold = 0.f;
  todo.level = 0;
  todo.stage = Stage::refine;
}

// Without limit in portions all the same, to be able to stop.
void sample_links(SolverState& state, std::size_t k, const Progress& progress,
                  IterationRecord& record) {
  Schedule& todo = state.schedule;
  const double power = received_power(state);
  for (std::size_t left = k; left > 0 && !todo.receivers.empty() && !progress.cancelled();) {
    const std::size_t n = std::min(
        left, state.options.memory > 0 ? kReceiversAtOnceInLittleMemory : kReceiversAtOnce);
    sample_receivers(state, n, power, record);
    left -= n;
    progress.report("solve", share_done(state));
  }
  if (!todo.receivers.empty()) return;
  if (todo.round > 1 && todo.short_of_memory == 0) forget_earlier_rounds(state);
  todo.stage = Stage::converge;
}

// All receive by sampled links already, and what is refined only shapes elements.
bool only_shapes(const SolverState& state, Stage stage) {
  return stage == Stage::shape || (stage == Stage::refine && state.schedule.round > 0);
}

bool finer_links_to_come(const Schedule& todo) {
  return todo.coarseness > 1.f || todo.stage != Stage::converge;
}

// As many as there is time for, as they get on the better the more of them follow each other.
int sweeps_within(const SolverState& state, double seconds) {
  const double each =
      state.costs.predict(Stage::converge, 0, state.tree.size() + state.link_total(), 1);
  const double most = std::clamp(seconds / std::max(each, 1e-9), double{kSweepsOfShortIteration},
                                 double{kMostSweepsOfShortIteration});
  return static_cast<int>(most);
}

int expected_sweeps(const SolverState& state, const IterationBudget& budget) {
  if (only_shapes(state, state.schedule.stage)) return 0;
  if (budget.limited()) {
    if (state.schedule.stage == Stage::converge) return sweeps_within(state, budget.seconds);
    if (state.schedule.stage == Stage::sample && state.history.empty()) return kSweepsOfFirstResult;
    const bool among_many = state.schedule.stage == Stage::sample && state.schedule.round > 1;
    return among_many ? 1 : kSweepsOfShortIteration;
  }
  const auto last = std::find_if(state.history.rbegin(), state.history.rend(),
                                 [](const IterationRecord& r) { return r.sweeps > 0; });
  return last != state.history.rend() ? last->sweeps : kFirstGuessOfSweeps;
}

// Of those that wait, until their rays are so many.
std::size_t receivers_within(const SolverState& state, std::size_t links) {
  const SampledLinkOptions options = sampled_link_options(state, received_power(state));
  const std::vector<ElementId>& waiting = state.schedule.receivers;
  std::size_t rays = 0;
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    rays += static_cast<std::size_t>(rays_of(state.tree, waiting[waiting.size() - 1 - k], options));
    if (rays > links) return k;
  }
  return waiting.size();
}

// Links to refine, pairs to shape or receivers to sample that the budget has room for; at least 1.
std::size_t units_within(const SolverState& state, const IterationBudget& budget, std::size_t size,
                         int sweeps) {
  const Stage stage = state.schedule.stage;
  // A part of the scene is no result.
  if (stage == Stage::sample && state.schedule.round == 1 && state.links.size() == 0)
    return kUnlimited;
  // Those of a coarse solution are few, and each iteration costs as much as its sweeps.
  const bool refines = stage == Stage::refine || stage == Stage::shape;
  if (refines && state.schedule.coarseness > 1.f && !state.history.empty()) return kUnlimited;
  const std::size_t links = stage == Stage::sample && budget.links < kUnlimited
                                ? receivers_within(state, budget.links)
                                : budget.links;
  const std::size_t in_time = std::isfinite(budget.seconds)
                                  ? state.costs.affordable(stage, budget.seconds, size, sweeps)
                                  : kUnlimited;
  return std::max<std::size_t>(1, std::min(links, in_time));
}

// What a stage needs to begin with.
void begin_stage(SolverState& state, bool in_short_iterations) {
  Schedule& todo = state.schedule;
  if (todo.irradiance_threshold == 0.f) {
    begin_level(state);
    if (todo.stage == Stage::shape && state.links.size() > 0) {
      todo.pairs = failing_pairs(state);
      if (in_short_iterations) shuffle_blocks(todo.pairs);
    }
    if (todo.stage != Stage::sample) update_given_light(state, todo.irradiance_threshold);
  }
  if (todo.stage == Stage::sample && todo.receivers.empty()) {
    if (!state.emitters)
      state.emitters =
          std::make_shared<EmitterTree>(*state.visibility, find_emitters(*state.world));
    ++todo.round;
    if (todo.coarseness > 1.f)
      limit_receivers(state, kCoarseReceivers);
    else
      todo.receiver_scale = 1.f;
    todo.receivers = receivers_of(state, {state.tree.root()});
    if (!state.importance.empty())
      std::erase_if(todo.receivers,
                    [&](ElementId e) { return state.importance[e] < kNegligibleImportance; });
    todo.receiver_total = todo.receivers.size();
    if (state.options.memory > 0)
      state.sampled_links.reserve(
          state.sampled_links.stored() +
          std::min(memory_room(state).sampled_links,
                   todo.receiver_total *
                       static_cast<std::size_t>(2 * sampled_link_options(state).rays_per_cluster)));
    if (in_short_iterations) shuffle_blocks(todo.receivers);
  }
}

void make_fine_parts(SolverState& state, const ClusterTree* clusters) {
  state.visibility = choose_visibility(state.world, *state.surfaces, clusters, state.options);
  if (state.emitters)
    state.emitters = std::make_shared<EmitterTree>(*state.visibility, find_emitters(*state.world));
  if (state.options.intra_cluster)
    state.inside = std::make_shared<const ClusterVisibility>(
        state.tree, state.opacity,
        choose_receivers(state.tree, {state.tree.root()}, state.receiver_sizes));
  state.fine_parts_made = true;
}

// These are an iteration of their own.
bool lacks_fine_parts(const SolverState& state) {
  return state.schedule.coarseness == 1.f && !state.fine_parts_made;
}

// A coarse solution has few refined links, and sampled ones for few receivers. Small scenes are lit
// sooner by the former, large ones by the latter.
void begin_coarsely(SolverState& state) {
  Schedule& todo = state.schedule;
  todo.coarseness = std::max(1.f, kFirstError / state.options.error);
  if (todo.coarseness == 1.f || state.options.links == LinkMaker::refined ||
      state.tree.size() < kManyElements)
    return;
  todo.stage = Stage::sample;
  todo.level = state.options.levels - 1;
}

}  // namespace

bool IterationBudget::limited() const { return std::isfinite(seconds) || links < kUnlimited; }

SolveOptions resolved(SolveOptions options, const World& world) {
  if (options.feature_size < 0.f) options.feature_size = world.geometry.bounds.diagonal() / 200.f;
  return options;
}

SolverState make_state(const std::shared_ptr<const World>& world, const SolveOptions& options,
                       Beginning beginning) {
  const auto surfaces = std::make_shared<const Surfaces>(build_surfaces(world->geometry));
  return make_state(world, surfaces,
                    find_live_sides(world->scene, world->geometry, *surfaces, world->rays), options,
                    beginning);
}

SolverState make_state(const std::shared_ptr<const World>& world,
                       const std::shared_ptr<const Surfaces>& surfaces,
                       const IdVector<SideId, std::uint8_t>& live, const SolveOptions& options,
                       Beginning beginning) {
  ClusterTree clusters = build_hierarchy(options.hierarchy, *surfaces);
  SolverState state{.world = world,
                    .surfaces = surfaces,
                    .tree = ElementTree(world->geometry, *surfaces, clusters, live),
                    .options = resolved(options, *world)};
  if (options.visibility != VisibilityMode::average) clusters = {};
  state.visibility = std::make_shared<Visibility>(*world);
  state.feature_size_rules = std::make_shared<const FeatureSizes>(
      *world, *surfaces, state.options.feature_size, options.feature_size_rules, options.pixels);
  state.feature_sizes = state.feature_size_rules->of_elements(state.tree);
  if (options.importance) state.seen = seen_surfaces(*world, *options.importance);

  const std::size_t n = state.tree.size();
  state.opacity.resize(n, 1.f);
  state.reflectance.resize(n);
  state.exitance.resize(n);
  state.given_light.resize(n, Rgb(0.f));
  state.given_share.resize(n, 1.f);
  state.given_light_known.resize(n, 0);
  if (has_outer_light(*world)) state.outer_light.resize(n, Rgb(0.f));
  state.irradiance.resize(n, Rgb(0.f));
  state.tolerance.resize(n, 1.f);
  state.sampled.resize(n, 0);
  state.radiosity.resize(n, Rgb(0.f));
  parallel_for(n, 256, [&](std::size_t i) {
    if (!state.tree[ElementId(i)].is_cluster()) evaluate_material(state, ElementId(i));
  });
  pull(state);
  state.receiver_sizes = receiver_sizes(state);
  state.schedule.pairs = {{state.tree.root(), state.tree.root()}};
  if (levels_of_links(state.options) == 0) state.schedule.stage = Stage::shape;
  if (beginning == Beginning::coarse) begin_coarsely(state);
  state.fine_parts_made = state.schedule.coarseness == 1.f || options.links == LinkMaker::refined ||
                          options.visibility == VisibilityMode::average;
  if (state.fine_parts_made) make_fine_parts(state, &clusters);
  return state;
}

void advance(SolverState& state, const Progress& progress, const IterationBudget& budget) {
  Schedule& todo = state.schedule;
  if (state.done()) return;
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t rays_before = state.world->rays.ray_total();
  if (lacks_fine_parts(state)) {
    IterationRecord record{.stage = todo.stage,
                           .links = state.link_total(),
                           .elements = state.tree.size(),
                           .predicted_seconds = least_iteration_seconds(state)};
    make_fine_parts(state, nullptr);
    record.refine_seconds = seconds_since(start);
    record.rays = state.world->rays.ray_total() - rays_before;
    state.history.push_back(record);
    return;
  }
  begin_stage(state, budget.limited());

  const Stage stage = todo.stage;
  const std::size_t size = state.tree.size() + state.link_total();
  const int sweeps = expected_sweeps(state, budget);
  const std::size_t k = units_within(state, budget, size, sweeps);
  IterationRecord record{.stage = stage, .irradiance_threshold = todo.irradiance_threshold};
  if (stage == Stage::refine) refine_links(state, k, progress, record);
  if (stage == Stage::shape) shape_elements(state, k, progress, record);
  if (stage == Stage::sample) sample_links(state, k, progress, record);
  if (record.refined > 0 && stage == Stage::refine && !only_shapes(state, stage))
    state.row_limits.clear();
  record.refine_seconds = seconds_since(start);
  // Of the units that were chosen, by what earlier iterations took.
  record.predicted_seconds = state.costs.predict(stage, record.refined, size, sweeps);
  const std::size_t new_size = state.tree.size() + state.link_total();
  // The first iteration starts from one link, like no other.
  if (!state.history.empty())
    state.costs.learn(stage, record.refined, record.refine_seconds, size, new_size);

  // While only elements are shaped, nothing new arrives anywhere.
  Sweeps swept;
  if (!only_shapes(state, stage))
    swept = sweep(state, budget.limited() ? sweeps : kMostSweeps,
                  finer_links_to_come(todo) ? kLittleChangeForNow : kLittleChange);
  if (todo.stage == Stage::converge && (swept.converged || !budget.limited())) {
    todo.stage = Stage::done;
    if (todo.coarseness > 1.f) go_on_from_coarse(state);
  }
  record.sweeps = swept.count;
  record.sweep_seconds = seconds_since(start) - record.refine_seconds;
  state.costs.learn_sweeps(new_size, swept.count, record.sweep_seconds);
  record.links = state.link_total();
  record.elements = state.tree.size();
  record.rays = state.world->rays.ray_total() - rays_before;
  state.history.push_back(record);
  progress.report("solve", share_done(state));
}

void aim_finer(SolverState& state, float factor) {
  state.options.error /= factor;
  begin_finer_links(state);
}

float aimed_error(const SolverState& state) {
  return state.schedule.coarseness * state.options.error;
}

double least_iteration_seconds(const SolverState& state) {
  if (lacks_fine_parts(state))
    return kFinePartsOfElement * static_cast<double>(state.tree.initial_size());
  return state.costs.predict(state.schedule.stage, 1, state.tree.size() + state.link_total(),
                             kSweepsOfShortIteration);
}

EnergyBalance energy_balance(const SolverState& state) {
  EnergyBalance balance;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) continue;
    const float area = state.tree[e].area;
    balance.emitted += area * state.exitance[e];
    if (!state.outer_light.empty())
      balance.emitted += area * state.opacity[e] * state.outer_light[e];
    const Rgb on_all = state.irradiance[e] - (1.f - state.given_share[e]) * state.given_light[e];
    balance.absorbed += area * (Rgb(state.opacity[e]) - state.reflectance[e]) * on_all;
  }
  balance.escaped = balance.emitted - balance.absorbed;
  return balance;
}

float mean_irradiance(const SolverState& state) {
  double power = 0.0, area = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    const float irradiance = average(state.irradiance[e]);
    if (!state.tree[e].is_leaf_cell() || !(irradiance > 0.f)) continue;
    power += static_cast<double>(state.tree[e].area * irradiance);
    area += static_cast<double>(state.tree[e].area);
  }
  return area > 0.0 ? static_cast<float>(power / area) : 0.f;
}

}  // namespace halflight
