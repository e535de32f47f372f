#include "halflight/solve/schedule.h"

#include <algorithm>
#include <cmath>

namespace halflight {
namespace {

constexpr float kLargestRelativeError = 1e6f;
constexpr double kWeightOfLast = 0.5;

void mix_in(double& average, double value, bool& known) {
  average = known ? (1.0 - kWeightOfLast) * average + kWeightOfLast * value : value;
  known = true;
}

}  // namespace

const char* name_of(Stage stage) {
  constexpr std::array names{"refine", "shape", "sample", "converge", "done"};
  return names[static_cast<std::size_t>(stage)];
}

std::size_t ErrorHistogram::bin_of(float relative_error) {
  const float error = std::clamp(relative_error, 1.f, kLargestRelativeError);
  const float position = std::log(error) / std::log(kLargestRelativeError);
  return std::min(static_cast<std::size_t>(position * static_cast<float>(kBins)), kBins - 1);
}

float ErrorHistogram::lower_edge(std::size_t bin) {
  return std::pow(kLargestRelativeError, static_cast<float>(bin) / static_cast<float>(kBins));
}

float ErrorHistogram::threshold_for(std::size_t k) const {
  std::size_t above = 0;
  for (std::size_t bin = kBins; bin-- > 0;) {
    if (above + counts_[bin] > k) return lower_edge(above > 0 && above >= k / 2 ? bin + 1 : bin);
    above += counts_[bin];
  }
  return 1.f;
}

double CostModel::predict(Stage stage, std::size_t units, std::size_t size, int sweeps) const {
  const double work = static_cast<double>(units);
  return work * of(stage).seconds +
         sweep_ * sweeps * (static_cast<double>(size) + work * of(stage).growth);
}

std::size_t CostModel::affordable(Stage stage, double seconds, std::size_t size, int sweeps) const {
  const double left = seconds - predict(stage, 0, size, sweeps);
  const double each = predict(stage, 1, 0, sweeps);
  if (!(left > 0.0)) return 0;
  return static_cast<std::size_t>(std::min(left / std::max(each, 1e-12), 1e15));
}

void CostModel::learn(Stage stage, std::size_t units, double seconds, std::size_t size_before,
                      std::size_t size_after) {
  if (units == 0) return;
  Work& work = work_[static_cast<std::size_t>(stage)];
  bool known = work.known;
  mix_in(work.seconds, seconds / static_cast<double>(units), known);
  const double grown = static_cast<double>(size_after) - static_cast<double>(size_before);
  mix_in(work.growth, std::max(0.0, grown / static_cast<double>(units)), work.known);
}

void CostModel::learn_sweeps(std::size_t size, int sweeps, double seconds) {
  if (sweeps == 0 || size == 0) return;
  mix_in(sweep_, seconds / (static_cast<double>(size) * sweeps), sweep_known_);
}

}  // namespace halflight
