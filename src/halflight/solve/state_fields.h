// All that a solve has brought about, field by field, for those who store or compare it. The tree's
// cells apart, what is not listed here follows from the scene, the options and what is listed.
#pragma once

#include <limits>

#include "halflight/solve/importance.h"
#include "halflight/solve/solver.h"
#include "halflight/solve/sweep.h"

namespace halflight {

// What a solve writes lies between these.
struct Range {
  double least = 0.0;
  double most = 1.0;
};
inline constexpr Range kShare{};
// W/m2. Scenes shine with kMaxRadiance at most, and lamps count by the square of the distance.
// Floats hold what comes of it by areas and weights.
inline constexpr Range kLight{0.0, 1e24};
inline constexpr Range kGivenShare{0.0, 1e6};
inline constexpr Range kThreshold{0.0, double{std::numeric_limits<float>::max()}};
inline constexpr Range kTolerance{1e-3, 1e3};
inline constexpr Range kImportance{double{kLeastImportance}, 1.0};
inline constexpr Range kWeight{0.0, 1e8};  // of links; what they hit may be next to transparent
inline constexpr Range kRounds{0.0, 64.0};
inline constexpr Range kLevels{0.0, 64.0};
inline constexpr Range kCount{0.0, 0x1p53};
inline constexpr Range kCoarseness{1.0, 1e6};
inline constexpr Range kReceiverScale{1.0, 1e12};
inline constexpr Range kSweeps{0.0, double{kMostSweeps}};

// visit(name, field) for lists of ids, link tables and the stage, visit(name, field, range) for
// numbers: arrays over elements and single values. Learnt costs are left out: they depend on the
// machine's mood.
template <class State, class Visit>
void for_each_field(State& state, const Visit& visit) {
  visit("opacity", state.opacity, kShare);
  visit("reflectance", state.reflectance, kShare);
  visit("exitance", state.exitance, kLight);
  visit("sampled", state.sampled, kRounds);
  visit("given light", state.given_light, kLight);
  visit("given share", state.given_share, kGivenShare);
  visit("given light known", state.given_light_known, kShare);
  visit("outer light", state.outer_light, kLight);
  visit("irradiance", state.irradiance, kLight);
  visit("tolerance", state.tolerance, kTolerance);
  visit("importance", state.importance, kImportance);
  visit("radiosity", state.radiosity, kLight);
  visit("links", state.links);
  visit("sampled links", state.sampled_links);
  visit("stage", state.schedule.stage);
  visit("level", state.schedule.level, kLevels);
  visit("irradiance threshold", state.schedule.irradiance_threshold, kThreshold);
  visit("pairs to refine", state.schedule.pairs);
  visit("receivers to sample", state.schedule.receivers);
  visit("receivers in all", state.schedule.receiver_total, kCount);
  visit("round", state.schedule.round, kRounds);
  visit("coarseness", state.schedule.coarseness, kCoarseness);
  visit("receiver scale", state.schedule.receiver_scale, kReceiverScale);
  visit("short of memory", state.schedule.short_of_memory, kShare);
}

// visit(name, pointer to member) or visit(name, pointer to member, range). Seconds are left out:
// equal solves then give equal bytes.
template <class Visit>
void for_each_record_field(const Visit& visit) {
  visit("stage", &IterationRecord::stage);
  visit("irradiance threshold", &IterationRecord::irradiance_threshold, kThreshold);
  visit("refined", &IterationRecord::refined, kCount);
  visit("links", &IterationRecord::links, kCount);
  visit("elements", &IterationRecord::elements, kCount);
  visit("pairs", &IterationRecord::pairs, kCount);
  visit("rays", &IterationRecord::rays, kCount);
  visit("sweeps", &IterationRecord::sweeps, kSweeps);
}

}  // namespace halflight
