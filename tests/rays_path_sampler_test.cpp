#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "halflight/rays/path_sampler.h"

namespace halflight {
namespace {

TEST(PathSampler, EveryAlignedBlockOf256PointsFillsEveryElementaryInterval) {
  // A (0,2)-sequence: 2^m consecutive points put one into each box of 2^-k by 2^-(m-k).
  for (const std::uint32_t first : {0u, 256u})
    for (int k = 0; k <= 8; ++k) {
      std::set<std::pair<int, int>> boxes;
      for (std::uint32_t i = first; i < first + 256; ++i) {
        PathSampler sampler(42, i);
        sampler.next_pair();
        const Vec2 u = sampler.next_pair();
        boxes.insert({static_cast<int>(u.x * static_cast<float>(1 << k)),
                      static_cast<int>(u.y * static_cast<float>(1 << (8 - k)))});
      }
      EXPECT_EQ(boxes.size(), 256u) << "width 2^-" << k;
    }
}

TEST(PathSampler, PairsOfOneSampleAreNotCorrelated) {
  double sum = 0.0;
  constexpr int kSamples = 4096;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    PathSampler sampler(7, i);
    const Vec2 a = sampler.next_pair(), b = sampler.next_pair();
    sum += (a.x - 0.5) * (b.x - 0.5);
  }
  // 1/12 is the variance of each; independent numbers leave 1 / (12 sqrt(4096)) = 0.0013.
  EXPECT_NEAR(sum / kSamples, 0.0, 0.005);
}

TEST(PathSampler, SeedsAreIndependent) {
  PathSampler a(1, 0), b(2, 0);
  EXPECT_NE(a.next_pair(), b.next_pair());
  EXPECT_NE(a.next_seed(), b.next_seed());
}

}  // namespace
}  // namespace halflight
