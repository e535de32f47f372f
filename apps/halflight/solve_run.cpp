#include "solve_run.h"

#include <algorithm>

#include <fmt/format.h>

#include "commands.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/scene/lint.h"
#include "halflight/solve/memory.h"
#include "halflight/solve/mix.h"

namespace halflight::app {
namespace {

// With a deadline an iteration takes at most this share of the time that is left: the costs of
// those to come are learnt from those that are done.
constexpr double kShareOfTimeLeft = 0.25;
// With a budget of links one iteration refines at most this share of those that are left, as
// several come of each.
constexpr std::size_t kShareOfLinksLeft = 8, kShareOfSampledLinksLeft = 2;
constexpr std::size_t kLeastForLinks = 20u << 20;
constexpr int kMostRounds = 4;      // of measuring the error and aiming at a smaller one
constexpr float kLeastGain = 0.9f;  // of the error by a round that was worth its time
constexpr float kSmallestStep = 1.5f, kLargestStep = 4.f;  // of the error that is aimed at

// Runs the schedule to its end; false when a budget ended before.
bool run_schedule(SolverState& state, const SolveGoals& goals, const Deadline& deadline,
                  const Progress& progress,
                  const std::function<void(const SolverState&)>& after_iteration) {
  while (!state.done()) {
    if (progress.cancelled() && !state.history.empty()) return false;
    IterationBudget budget;
    if (deadline.set()) {
      const double left = deadline.seconds_left();
      const double least = least_iteration_seconds(state);
      if (!state.history.empty() && least > left) return false;
      budget.seconds = std::min(left, std::max(kShareOfTimeLeft * left, 2.0 * least));
    }
    if (goals.links) {
      if (state.link_total() >= *goals.links) return false;
      const std::size_t share =
          state.schedule.stage == Stage::sample ? kShareOfSampledLinksLeft : kShareOfLinksLeft;
      budget.links = std::max<std::size_t>(1, (*goals.links - state.link_total()) / share);
    }
    advance(state, progress, budget);
    if (after_iteration) after_iteration(state);
  }
  return true;
}

// Of light that is not refined any more.
bool meets(const SolveGoals& goals, const SolverState& state, const EstimatedError& error) {
  const bool accurate = !goals.error || error.relative_rms <= *goals.error;
  return state.done() && state.schedule.short_of_memory == 0 && accurate;
}

}  // namespace

Beginning beginning_of(const SolveOptions& options, const Deadline& deadline) {
  return deadline.set() && options.memory == 0 ? Beginning::coarse : Beginning::as_asked;
}

Result<SolverState> begin_solve(const std::shared_ptr<const World>& world,
                                const SolveOptions& options, Beginning beginning,
                                std::size_t for_outputs) {
  if (const auto finding = far_corners(world->geometry))
    warn(fmt::format("{} ({})", finding->message, finding->remedy));
  if (options.memory == 0) return make_state(world, options, beginning);
  const auto check = [&](std::size_t bytes, const char* of) -> Result<void> {
    if (bytes <= options.memory) return {};
    return input_error(
        fmt::format("--memory {} MiB leaves no room for {}", options.memory >> 20, of), {},
        fmt::format("give at least {} MiB", (bytes >> 20) + 1));
  };
  const std::size_t of_world = bytes_of_world(*world);
  const std::size_t triangles = world->geometry.triangles.size();
  if (auto ok = check(of_world + bytes_of_hierarchy(triangles, 0), "the scene"); !ok)
    return tl::unexpected(ok.error());
  const auto surfaces = std::make_shared<const Surfaces>(build_surfaces(world->geometry));
  const std::size_t bytes = of_world + bytes_of_hierarchy(triangles, surfaces->surfaces.size());
  if (auto ok = check(bytes + kLeastForLinks, "the scene and its hierarchy"); !ok)
    return tl::unexpected(ok.error());
  if (auto ok = check(bytes + for_outputs, "the lit scene (-o)"); !ok)
    return tl::unexpected(ok.error());
  return make_state(world, surfaces,
                    find_live_sides(world->scene, world->geometry, *surfaces, world->rays),
                    options);
}

SolveOutcome run_to_goal(SolverState& state, const SolveGoals& goals, const Deadline& deadline,
                         const Progress& progress, bool wants_error,
                         const std::function<void(const SolverState&)>& after_iteration) {
  SolveOutcome outcome;
  const auto run = [&] {
    return run_schedule(state, goals, deadline, progress, after_iteration) &&
           state.schedule.short_of_memory == 0;
  };
  outcome.goal_met = run();
  if (!goals.error && !(wants_error && outcome.goal_met)) return outcome;
  // No time is left to measure in.
  if (progress.cancelled() || (deadline.set() && !outcome.goal_met)) return outcome;
  const ErrorProbes probes(state, progress);
  outcome.error = probes.measure(state, progress);
  if (!outcome.error) return outcome;
  if (state.grouped.separated()) {
    outcome.goal_met = meets(goals, state, *outcome.error);
    return outcome;
  }
  if (!goals.error) return outcome;
  // A solve that was resumed has some of its rounds behind it.
  const bool had_coarse_rounds = beginning_of(state.options, deadline) == Beginning::coarse;
  for (int round = had_coarse_rounds ? 1 : std::max<int>(1, state.schedule.round);
       outcome.goal_met && !(outcome.error->relative_rms <= *goals.error); ++round) {
    if (round == kMostRounds) {
      outcome.goal_met = false;
      break;
    }
    const float before = outcome.error->relative_rms;
    aim_finer(state, std::clamp(before / *goals.error, kSmallestStep, kLargestStep));
    outcome.goal_met = run();
    const auto error = probes.measure(state, progress);
    if (!error) break;
    outcome.error = error;
    if (outcome.error->relative_rms > std::max(*goals.error, kLeastGain * before))
      outcome.goal_met = false;
  }
  return outcome;
}

void separate_groups(SolverState& state, const SolveGoals& goals, const Progress& progress,
                     SolveOutcome& outcome) {
  separate(state, progress);
  if (!outcome.error || progress.cancelled()) return;
  const auto error = ErrorProbes(state, progress).measure(state, progress);
  if (!error) return;
  outcome.error = error;
  outcome.goal_met = meets(goals, state, *outcome.error);
}

}  // namespace halflight::app
