// Whole solutions at rising feature sizes, judged in flat pictures: what the feature size saves and
// what it costs.
#pragma once

#include <string>
#include <vector>

#include "experiments/flat_view.h"
#include "halflight/output/read_light.h"

namespace halflight::experiments {

struct StudyCost {
  double seconds = 0, cpu_seconds = 0;  // of solving
  double reading_seconds = 0;           // of the pictures
  std::uint64_t rays = 0;               // of solving, exact and through clusters
  std::uint64_t nodes = 0;              // of the multi-resolution tree, for these and the pictures
  std::size_t elements = 0, links = 0;
};

// Solved and seen in every view.
struct StudySolution {
  float feature_size = 0.f;  // metres
  StudyCost cost;
  std::vector<Image> pictures;  // irradiance
};
StudySolution solve_and_look(const std::shared_ptr<const World>& world, const SolveOptions& options,
                             const std::vector<FlatView>& views, const ReadOptions& reading,
                             const Progress& progress);

struct StudyError {
  double l2 = 0;          // as shares of the reference's mean irradiance
  double fbem = 0;        // with this feature size
  double mask_share = 0;  // of the picture: features wider than that
};
StudyError judge(const FlatView& view, const Image& reference, const Image& picture,
                 const BinaryImage& shadow, float feature_size);

}  // namespace halflight::experiments
