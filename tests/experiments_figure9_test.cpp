// Figure 9: costs fall with the feature size, and groups are averaged in the order of their sizes.
#include <gtest/gtest.h>

#include "experiments/figure9.h"

namespace halflight::experiments {
namespace {

class Figure9 : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Figure9, testing::Range(1, 4));

TEST_P(Figure9, CostsFallAndGroupsSwitchFromSmallToLarge) {
  const auto walls = light_wall_by_multires(GetParam());
  ASSERT_EQ(walls.size(), kFeatureSizes.size() + 1);
  for (std::size_t i = 1; i < walls.size(); ++i) {
    EXPECT_LT(walls[i].nodes_per_ray, walls[i - 1].nodes_per_ray);
    EXPECT_LT(walls[i].clusters_per_ray, walls[i - 1].clusters_per_ray);
    for (std::size_t group = 0; group < kGroups; ++group) {
      const double s = walls[i].feature_size, size = kShadowSizes[group];
      const double l2 = walls[i].l2[group], fbem = walls[i].fbem[group];
      if (s < 0.9 * size) {
        // Nothing to speak of is averaged whose shadows are wider than s.
        EXPECT_LT(l2, 1.0) << s << " " << size;
      } else if (s >= 1.15 * size) {
        EXPECT_GT(l2, 4.0) << s << " " << size;
        EXPECT_LT(fbem, 0.75 * l2) << s << " " << size;
      }
      if (s >= 2.0 * size) {
        EXPECT_LT(fbem, 0.6 * l2) << s << " " << size;
      }
      EXPECT_GE(l2, walls[i - 1].l2[group] - 0.3) << s << " " << size;
      if (group > 0) {
        EXPECT_LE(l2, walls[i].l2[group - 1] + 1e-9) << "larger groups switch later";
      }
    }
  }
  EXPECT_GT(walls.front().nodes_per_ray, 1.4 * walls.back().nodes_per_ray);
}

}  // namespace
}  // namespace halflight::experiments
