// Iterates a solver until the goal is met or a budget ends.
#pragma once

#include <functional>
#include <optional>

#include "halflight/output/estimated_error.h"
#include "halflight/solve/solver.h"
#include "solve_arguments.h"

namespace halflight::app {

struct SolveOutcome {
  bool goal_met = false;  // else a budget ended, or the error would not fall any further
  std::optional<EstimatedError> error;
};

// Whenever a deadline comes, all of the light shall be there. Rounds that memory cuts short are
// never made finer.
Beginning beginning_of(const SolveOptions& options, const Deadline& deadline);

// A fresh state; an error where a limit on memory leaves no room for the scene, its hierarchy and
// `for_outputs`, bytes that writing takes after the links are gone.
Result<SolverState> begin_solve(const std::shared_ptr<const World>& world,
                                const SolveOptions& options, Beginning beginning,
                                std::size_t for_outputs = 0);

// `after_iteration` is called with a valid state. The error is measured when it is a goal, or when
// `wants_error`. Light that has been taken apart into its groups is done: it is only measured.
SolveOutcome run_to_goal(SolverState& state, const SolveGoals& goals, const Deadline& deadline,
                         const Progress& progress, bool wants_error,
                         const std::function<void(const SolverState&)>& after_iteration = {});

// Takes the light apart into its groups, which leaves the balance that the solve has kept between
// them: what was measured before is measured anew, on the sum that is written.
void separate_groups(SolverState& state, const SolveGoals& goals, const Progress& progress,
                     SolveOutcome& outcome);

}  // namespace halflight::app
