// How far a solution is from the truth, measured: read it at scattered points and compare with
// paths traced there that know nothing of it.
#pragma once

#include <optional>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/output/read_light.h"
#include "halflight/solve/solver.h"

namespace halflight {

// Points spread evenly over the area of all sides that can see light.
std::vector<ReadingPoint> scatter_points(const SolverState& state, std::size_t count);

struct EstimatedError {
  // RMS over the scene's area, or over the picture that is important, of the error of irradiance,
  // relative to the scene's mean irradiance or, where there is more light, to that of the place: a
  // few places inside lamps would outweigh all others.
  float relative_rms = 0.f;  // not below `least`
  float least = 0.f;         // errors below this drown in the noise of the paths
  float mean = 0.f;          // irradiance by the paths, W/m2
};

// With two independent estimates a, b of the true irradiance at a point, of any noise but without
// bias, (e - a)(e - b) is an estimate of the squared error of e without bias. Averaged over points
// it needs few paths, as the noise of the paths does not add to it.
class ErrorProbes {
 public:
  explicit ErrorProbes(const SolverState& state, const Progress& progress = Progress());

  // Refers to the same scene as that of the constructor. Nothing where either was cancelled.
  std::optional<EstimatedError> measure(const SolverState& state,
                                        const Progress& progress = Progress()) const;

 private:
  struct Truth {
    Rgb first{0.f}, second{0.f};  // independent estimates
    Rgb mean() const { return 0.5f * (first + second); }
  };
  float mean_irradiance() const;

  std::vector<ReadingPoint> points_;
  std::vector<Truth> truths_;
};

}  // namespace halflight
