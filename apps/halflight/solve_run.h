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

// `after_iteration` is called with a valid state. The error is measured when it is a goal, or when
// `wants_error`.
SolveOutcome run_to_goal(SolverState& state, const SolveGoals& goals, const Deadline& deadline,
                         const Progress& progress, bool wants_error,
                         const std::function<void(const SolverState&)>& after_iteration = {});

}  // namespace halflight::app
