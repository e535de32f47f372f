// Section 6.2: progressive multi-gridding, iterations of a length that is asked for.
#pragma once

#include <vector>

#include "halflight/base/progress.h"
#include "halflight/solve/solver.h"

namespace halflight::experiments {

// A room full of loose triangles, lit by iterations of a wanted length.
struct MultigridRun {
  int polygons = 0;
  double wanted_seconds = 0;  // of an iteration
  double world_seconds = 0;   // until rays can be traced: what others call loading
  double first_seconds = 0;   // from then to the first result
  std::vector<IterationRecord> iterations{};
  bool finished = false;

  double median_seconds() const;  // of an iteration, and so on
  double longest_seconds() const;
  // From the third iteration on: how far the prediction was off, as a factor of at least 1.
  double median_misprediction() const;
  double largest_misprediction() const;
};

// Stops after so many iterations.
MultigridRun run_multigrid(int polygons, double wanted_seconds, int most_iterations,
                           const Progress& progress);

}  // namespace halflight::experiments
