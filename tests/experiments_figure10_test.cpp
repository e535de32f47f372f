// Figure 10: one link to a shelf of books, and the shelf solved.
#include "experiments/figure10.h"

#include <gtest/gtest.h>

#include "halflight/scene/procedural/books.h"

namespace halflight::experiments {
namespace {

class Figure10 : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Figure10, testing::Range(1, 4));

TEST_P(Figure10, OnlyTheSilhouettesLightIsHandedOut) {
  const LinkToBooks link = link_light_to_books(GetParam(), 48, 48);
  EXPECT_NEAR(link.given_with / link.silhouette, 1.0, 0.02);
  EXPECT_GT(link.given_without / link.silhouette, 3.0);
  EXPECT_LT(link.hidden_with, 0.005 * link.given_with);
  EXPECT_GT(link.hidden_without, 0.5 * link.given_without);
}

TEST(Figure10Solved, BooksAreNearerToThePathTracedWithIntraClusterVisibility) {
  const auto solved = solve_with_and_without(books_scene(), 0.4f);
  ASSERT_EQ(solved.size(), 4u);
  for (std::size_t links = 0; links < 4; links += 2) {
    const SolvedClusters &without = solved[links], &with = solved[links + 1];
    EXPECT_FALSE(without.intra_cluster);
    EXPECT_TRUE(with.intra_cluster);
    EXPECT_LT(with.error, 0.75 * without.error);
    EXPECT_NEAR(with.absorbed, 1.0, with.refined_links ? 0.045 : 0.01);
  }
}

}  // namespace
}  // namespace halflight::experiments
