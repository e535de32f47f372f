// The cluttered office of the paper's title, solved with multi-resolution visibility at rising
// feature sizes.
#pragma once

#include <array>

#include "experiments/feature_study.h"

namespace halflight::experiments {

inline constexpr std::array kClutterShares{0.01, 0.02, 0.05, 0.1};  // of the room's diagonal

struct ClutterStudy {
  std::size_t triangles = 0;
  float diagonal = 0.f;  // metres
  std::vector<FlatView> views;
  std::vector<BinaryImage> shadows;  // of each view
  // The reference, exact at feature size 0, then one for each share.
  std::vector<StudySolution> solutions;
  std::vector<std::vector<StudyError>> errors;  // of those, for each view
};
// An office of `count` small things; views of `pixels` along their longer side; solved to this
// relative error.
ClutterStudy study_clutter(int count, int pixels, float error, const Progress& progress);

}  // namespace halflight::experiments
