#include <gtest/gtest.h>

#include "halflight/base/ids.h"
#include "halflight/base/parallel.h"

namespace halflight {
namespace {

TEST(Parallel, CollectKeepsIndexOrder) {
  const auto even = parallel_collect<std::size_t>(10001, 16, [](std::size_t i, auto& out) {
    if (i % 2 == 0) out.push_back(i);
  });
  ASSERT_EQ(even.size(), 5001u);
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_EQ(even[i], 2 * i);
}

TEST(Parallel, SumIsTheSameForAnyThreadCount) {
  const auto term = [](std::size_t i) { return 1.0f / static_cast<float>(i + 1); };
  set_thread_count(1);
  const float one = parallel_sum(100000, 64, 0.f, term);
  set_thread_count(0);
  const float all = parallel_sum(100000, 64, 0.f, term);
  EXPECT_EQ(one, all);
}

}  // namespace
}  // namespace halflight
