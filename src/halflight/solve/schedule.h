// What the solver does next, and what that will cost (paper section 6.2, progressive
// multi-gridding): the distribution of link errors tells which threshold at most k links exceed,
// and the last iterations tell how long it takes to refine them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "halflight/transport/refine.h"

namespace halflight {

enum class Stage : std::uint8_t {
  refine,    // links, level by level of the threshold
  shape,     // elements alone, for the last level
  sample,    // give receivers sampled links
  converge,  // nothing but sweeps
  done,
};
const char* name_of(Stage stage);

struct Schedule {
  Stage stage = Stage::refine;
  int level = 0;                       // of the threshold, from 0, the coarsest
  float irradiance_threshold = 0.f;    // of this level; 0: not begun
  std::vector<ElementPair> pairs{};    // to be refined before anything else, last first
  std::vector<ElementId> receivers{};  // that still need sampled links, last first
  std::size_t receiver_total = 0;      // of which they are left
  std::uint8_t round = 0;              // of sampled links, from 1
  float coarseness = 1.f;              // of the error aimed at, in those asked for
  float receiver_scale = 1.f;          // of clusters that receive as one, in feature sizes
  std::uint8_t short_of_memory = 0;    // 1: something was made coarser for lack of it
};

// What one iteration did (the report's history).
struct IterationRecord {
  Stage stage = Stage::refine;
  float irradiance_threshold = 0.f;  // that the links made hold
  std::size_t refined = 0;           // links refined, pairs shaped, or receivers sampled
  std::size_t links = 0;
  std::size_t elements = 0;
  std::uint64_t pairs = 0;  // judged
  std::uint64_t rays = 0;
  int sweeps = 0;
  double predicted_seconds = 0.0;
  double refine_seconds = 0.0;
  double sweep_seconds = 0.0;
  double seconds() const { return refine_seconds + sweep_seconds; }
};

// Counts in logarithmic bins of an error relative to the threshold, for errors above 1.
class ErrorHistogram {
 public:
  void add(float relative_error) { ++counts_[bin_of(relative_error)]; }
  // The smallest edge of a bin such that at most k errors lie above it; where that would leave more
  // than half of k unused, the edge below, and only some of the errors above it can be dealt with.
  // At least 1.
  float threshold_for(std::size_t k) const;

 private:
  static constexpr std::size_t kBins = 256;
  static std::size_t bin_of(float relative_error);
  static float lower_edge(std::size_t bin);
  std::array<std::size_t, kBins> counts_{};
};

// Seconds of an iteration: so many for each unit of its stage's work (a link to refine, a pair, a
// receiver), and for each link and element that a sweep visits. Learnt by exponential averages.
class CostModel {
 public:
  // `size` is the number of links and elements, of which the work adds some.
  double predict(Stage stage, std::size_t units, std::size_t size, int sweeps) const;
  // Units of work that fit into the seconds; 0 when nothing does.
  std::size_t affordable(Stage stage, double seconds, std::size_t size, int sweeps) const;
  void learn(Stage stage, std::size_t units, double seconds, std::size_t size_before,
             std::size_t size_after);
  void learn_sweeps(std::size_t size, int sweeps, double seconds);

 private:
  struct Work {
    double seconds = 0.0;  // of a unit
    double growth = 0.0;   // links and elements that come of it
    bool known = false;
  };
  const Work& of(Stage stage) const { return work_[static_cast<std::size_t>(stage)]; }
  // To be careful with, before anything is known.
  std::array<Work, 5> work_{{{5e-5, 10.0}, {3e-5, 1.0}, {1e-4, 64.0}, {}, {}}};
  double sweep_ = 2e-8;
  bool sweep_known_ = false;
};

}  // namespace halflight
