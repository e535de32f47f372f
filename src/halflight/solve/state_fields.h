// All that a solve has brought about, field by field, for those who store or compare it. The tree's
// cells apart, what is not listed here follows from the scene, the options and what is listed.
#pragma once

#include "halflight/solve/solver.h"

namespace halflight {

// visit(name, field) for arrays over elements, link tables, lists and single values. Learnt costs
// are left out: they depend on the machine's mood.
template <class State, class Visit>
void for_each_field(State& state, const Visit& visit) {
  visit("opacity", state.opacity);
  visit("reflectance", state.reflectance);
  visit("exitance", state.exitance);
  visit("sampled", state.sampled);
  visit("given light", state.given_light);
  visit("given light known", state.given_light_known);
  visit("outer light", state.outer_light);
  visit("irradiance", state.irradiance);
  visit("tolerance", state.tolerance);
  visit("importance", state.importance);
  visit("radiosity", state.radiosity);
  visit("links", state.links);
  visit("sampled links", state.sampled_links);
  visit("stage", state.schedule.stage);
  visit("level", state.schedule.level);
  visit("irradiance threshold", state.schedule.irradiance_threshold);
  visit("pairs to refine", state.schedule.pairs);
  visit("receivers to sample", state.schedule.receivers);
  visit("receivers in all", state.schedule.receiver_total);
  visit("round", state.schedule.round);
  visit("coarseness", state.schedule.coarseness);
  visit("short of memory", state.schedule.short_of_memory);
}

// visit(name, pointer to member). Seconds are left out: equal solves then give equal bytes.
template <class Visit>
void for_each_record_field(const Visit& visit) {
  visit("stage", &IterationRecord::stage);
  visit("irradiance threshold", &IterationRecord::irradiance_threshold);
  visit("refined", &IterationRecord::refined);
  visit("links", &IterationRecord::links);
  visit("elements", &IterationRecord::elements);
  visit("pairs", &IterationRecord::pairs);
  visit("rays", &IterationRecord::rays);
  visit("sweeps", &IterationRecord::sweeps);
}

}  // namespace halflight
