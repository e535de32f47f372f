// Sequences of sample points.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::uint32_t kPoints = 1024;

// Boxes of [0, 1)^4 hold their share of the pairs, as they would not if the second point of a pair
// followed from the first.
TEST(CompanionSequence, PairsFillFourDimensions) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Vec2 shift_a = random_shift(seed), shift_b = random_shift(hash(seed, 9));
    std::array<int, 16> in_box{};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Vec2 a = r2_sequence(i, shift_a), b = companion_sequence(i, shift_b);
      ++in_box[(a.x < 0.5f) + 2 * (a.y < 0.5f) + 4 * (b.x < 0.5f) + 8 * (b.y < 0.5f)];
    }
    const auto [least, most] = std::minmax_element(in_box.begin(), in_box.end());
    EXPECT_GT(*least, kPoints / 16 * 3 / 4);
    EXPECT_LT(*most, kPoints / 16 * 5 / 4);
  }
}

TEST(CompanionSequence, AnyPrefixIsSpread) {
  for (std::uint32_t n : {16u, 64u, 256u}) {
    std::array<std::uint32_t, 4> in_box{};
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec2 u = companion_sequence(i);
      ++in_box[(u.x < 0.5f) + 2 * (u.y < 0.5f)];
    }
    for (const std::uint32_t count : in_box) {
      EXPECT_GE(count, n / 4 - n / 8);
      EXPECT_LE(count, n / 4 + n / 8);
    }
  }
}

}  // namespace
}  // namespace halflight
