// -o of what solves or mixes: the lit scene of a solution.
#pragma once

#include <filesystem>

#include "halflight/base/progress.h"
#include "halflight/base/result.h"
#include "halflight/output/report.h"
#include "halflight/solve/solver.h"

namespace halflight::app {

// Also tells the report how long it took and what the mesh is like.
Result<void> write_lit(const std::filesystem::path& path, const SolverState& state, Report& report,
                       const Progress& progress);

}  // namespace halflight::app
