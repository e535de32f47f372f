#include <gtest/gtest.h>

#include "features_fixtures.h"
#include "halflight/features/distance_transform.h"
#include "halflight/features/morphology.h"
#include "halflight/features/regions.h"
#include "halflight/features/widths.h"

namespace halflight {
namespace {

using test::filled_rectangle;
using test::random_bits;
using test::random_rectangles;

// The paper's words: a set pixel that has a clear neighbour becomes clear.
BinaryImage erode_by_definition(const BinaryImage& in, Connectivity connectivity, Outside outside) {
  BinaryImage out = in;
  const auto clear = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < in.width() && y < in.height();
    return inside ? !in.at(x, y) : outside == Outside::clear;
  };
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const bool neighbour = connectivity == Connectivity::eight || dx == 0 || dy == 0;
          if (neighbour && clear(x + dx, y + dy)) out.set(x, y, false);
        }
  return out;
}

constexpr Connectivity kConnectivities[] = {Connectivity::four, Connectivity::eight};

TEST(Morphology, ErosionsAtOnceEqualErosionsOneByOne) {
  for (const auto& [width, height] : {std::pair{64, 40}, {200, 130}, {131, 65}, {7, 300}})
    for (const Connectivity connectivity : kConnectivities)
      for (const Outside outside : {Outside::ignored, Outside::clear}) {
        const BinaryImage image = complement(random_rectangles(width, height, 9, 5));
        BinaryImage stepwise = image;
        for (int n = 1; n <= 24; ++n) {
          stepwise = erode_by_definition(stepwise, connectivity, outside);
          ASSERT_EQ(erode(image, n, connectivity, outside), stepwise)
              << width << 'x' << height << ", " << n << " erosions";
        }
      }
}

TEST(Morphology, ExpansionSetsEveryPixelWithASetPixelWithinReach) {
  const int n = 5;
  const BinaryImage image = random_bits(90, 70, 0.01f, 3);
  for (const Connectivity connectivity : kConnectivities) {
    const BinaryImage expanded = expand(image, n, connectivity);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 90; ++x) {
        bool reached = false;
        for (int v = std::max(0, y - n); v <= std::min(69, y + n); ++v)
          for (int u = std::max(0, x - n); u <= std::min(89, x + n); ++u) {
            const int du = std::abs(u - x), dv = std::abs(v - y);
            const int distance = connectivity == Connectivity::four ? du + dv : std::max(du, dv);
            reached |= distance <= n && image.at(u, v);
          }
        ASSERT_EQ(expanded.at(x, y), reached) << x << ", " << y;
      }
  }
}

TEST(Morphology, OpeningKeepsASquareIffItIsWiderThanTwiceTheErosions) {
  for (int n = 0; n <= 12; ++n)
    for (int width = 1; width <= 26; ++width) {
      const BinaryImage square = filled_rectangle(100, 80, 30, 20, width, width);
      const BinaryImage expected = width > 2 * n ? square : BinaryImage(100, 80);
      ASSERT_EQ(opening(square, n), expected) << width << " wide, " << n << " erosions";
    }
}

TEST(Morphology, DistanceCountsTheErosionsThatAPixelSurvives) {
  const BinaryImage image = complement(random_rectangles(150, 90, 6, 8));
  for (const Connectivity connectivity : kConnectivities)
    for (const Outside outside : {Outside::ignored, Outside::clear}) {
      const auto distance = distance_to_clear(image, connectivity, outside);
      for (const int n : {1, 2, 7, 20}) {
        const BinaryImage eroded = erode(image, n, connectivity, outside);
        for (int y = 0; y < 90; ++y)
          for (int x = 0; x < 150; ++x)
            ASSERT_EQ(eroded.at(x, y), distance[static_cast<std::size_t>(y * 150 + x)] >
                                           static_cast<std::uint32_t>(n));
      }
    }
}

bool square_fits(const BinaryImage& image, int side) {
  for (int top = 0; top + side <= image.height(); ++top)
    for (int left = 0; left + side <= image.width(); ++left) {
      bool full = true;
      for (int y = top; full && y < top + side; ++y)
        for (int x = left; full && x < left + side; ++x) full = image.at(x, y);
      if (full) return true;
    }
  return false;
}

TEST(Widths, LargestSquareIsTheLargestThatFits) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const int width = seed % 2 ? 50 : 120;
    const BinaryImage image = random_rectangles(width, 45, 5, seed);
    const int side = largest_square(image);
    EXPECT_TRUE(side == 0 || square_fits(image, side)) << seed;
    EXPECT_FALSE(square_fits(image, side + 1)) << seed;
    EXPECT_EQ(largest_square_by_distance(image), largest_square_by_erosion(image)) << seed;
  }
}

TEST(Widths, ASquareIsAsWideWhereverItLies) {
  for (int width = 1; width <= 50; ++width)
    for (int left = 0; left + width <= 128; left += 7)
      ASSERT_EQ(largest_square_by_erosion(filled_rectangle(128, 60, left, 4, width, width)), width)
          << "at " << left;
}

TEST(Widths, BlockedAndFreeAreMeasuredInsideTheImageOnly) {
  const BinaryImage bar = filled_rectangle(300, 200, 0, 60, 300, 31);
  EXPECT_EQ(blocked_width(bar), 31);
  EXPECT_EQ(free_width(bar), 200 - 60 - 31);
  EXPECT_EQ(blocked_width(BinaryImage(40, 64, true)), 40);
  EXPECT_EQ(free_width(BinaryImage(40, 64, true)), 0);
}

TEST(Widths, ARegionVanishesAfterHalfItsWidthErosions) {
  for (int width = 1; width <= 40; ++width) {
    const BinaryImage square = filled_rectangle(64, 64, 3, 5, width, width);
    EXPECT_EQ(erosions_until_empty(square, Connectivity::eight), (width + 1) / 2);
    EXPECT_EQ(erosions_until_empty(square, Connectivity::four), (width + 1) / 2);
  }
  // A diamond of radius 15 takes 16 erosions by its own shape and only 8 by the inscribed square.
  BinaryImage centre(64, 64);
  centre.set(30, 30);
  const BinaryImage diamond = expand(centre, 15, Connectivity::four);
  EXPECT_EQ(erosions_until_empty(diamond, Connectivity::four), 16);
  EXPECT_EQ(largest_square(diamond), 15);
}

TEST(Regions, CornersTouchWithEightNeighboursOnly) {
  BinaryImage image(10, 10);
  for (int i = 0; i < 10; ++i) image.set(i, i);
  EXPECT_EQ(connected_regions(image, Connectivity::eight).regions.size(), 1u);
  EXPECT_EQ(connected_regions(image, Connectivity::four).regions.size(), 10u);
}

TEST(Regions, BoundingBoxAndAreaOfAUShapeAreThoseOfTheWhole) {
  BinaryImage image = filled_rectangle(40, 30, 4, 3, 3, 20);
  image = unite(image, filled_rectangle(40, 30, 20, 1, 3, 22));
  image = unite(image, filled_rectangle(40, 30, 4, 20, 19, 3));
  const Regions found = connected_regions(image);
  ASSERT_EQ(found.regions.size(), 1u);
  const Region& r = found.regions[0];
  EXPECT_EQ(r.left, 4);
  EXPECT_EQ(r.top, 1);
  EXPECT_EQ(r.width, 19);
  EXPECT_EQ(r.height, 22);
  EXPECT_EQ(r.pixels, image.count());
}

}  // namespace
}  // namespace halflight
