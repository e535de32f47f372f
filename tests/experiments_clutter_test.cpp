// The cluttered office: costs fall with the feature size, and what is lost is small features.
#include <gtest/gtest.h>

#include "experiments/clutter.h"

namespace halflight::experiments {
namespace {

TEST(Clutter, CostsFallAndErrorsAreBelowTheFeatureSize) {
  const ClutterStudy study = study_clutter(0, 64, 0.15f, Progress());
  ASSERT_EQ(study.solutions.size(), kClutterShares.size() + 1);
  for (std::size_t i = 1; i < study.solutions.size(); ++i) {
    const StudyCost &now = study.solutions[i].cost, &before = study.solutions[i - 1].cost;
    EXPECT_LT(now.elements, before.elements) << i;
    EXPECT_LT(now.links, before.links) << i;
    EXPECT_LT(now.rays, before.rays) << i;
    for (const StudyError& e : study.errors[i]) {
      EXPECT_LE(e.fbem, e.l2 * 1.001) << i;
      EXPECT_LT(e.l2, 0.15) << i;
      EXPECT_GT(e.l2, 0.0) << i;
    }
  }
  EXPECT_LT(2 * study.solutions.back().cost.links, study.solutions.front().cost.links);
  // Shadows narrower than a tenth of the room: their errors average out.
  for (const StudyError& e : study.errors.back()) EXPECT_LT(e.fbem, 0.99 * e.l2);
}

}  // namespace
}  // namespace halflight::experiments
