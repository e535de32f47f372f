#include <gtest/gtest.h>

#include <cmath>

#include "features_fixtures.h"
#include "halflight/base/parallel.h"
#include "halflight/features/box_filter.h"
#include "halflight/features/compare.h"
#include "halflight/features/feature_mask.h"
#include "halflight/features/shadow_estimate.h"
#include "halflight/features/visibility_error.h"

namespace halflight {
namespace {

using test::filled_rectangle;
using test::random_image;
using test::random_rectangles;

constexpr double kRounding = 1e-6;  // of pixel values that are floats of order 1

// A wall of light 1 with shadows of light 0.
Image picture_of(const BinaryImage& shadow) {
  Image image(shadow.width(), shadow.height(), Rgb(1.f));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (shadow.at(x, y)) image.at(x, y) = Rgb(0.f);
  return image;
}

CompareOptions at(std::vector<double> feature_sizes, double p = 2) {
  CompareOptions options;
  options.feature_sizes = std::move(feature_sizes);
  options.p = p;
  return options;
}

Image uniform_mean_of(const Image& image) {
  glm::dvec3 sum(0);
  for (const Rgb& c : image.pixels) sum += glm::dvec3(c);
  return Image(image.width, image.height, Rgb(sum / static_cast<double>(image.pixels.size())));
}

TEST(FeatureMask, AFeatureSurvivesIffItIsWiderThanTheFeatureSize) {
  for (int s = 1; s <= 40; ++s)
    for (int width = 1; width <= 60; ++width) {
      const BinaryImage shadow = filled_rectangle(120, 100, 20, 20, width, width);
      const bool survives = feature_mask(shadow, s) == shadow;
      EXPECT_TRUE(survives || feature_mask(shadow, s).count() == 0);
      // Odd sizes round to the next even one: width s + 1 may go.
      const bool decided = s % 2 == 0 || width != s + 1;
      EXPECT_TRUE(!decided || survives == (width > s)) << "width " << width << ", s = " << s;
    }
}

TEST(FeatureMask, MasksShrinkAsTheFeatureSizeGrows) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const BinaryImage shadow = random_rectangles(200, 200, 25, seed);
    for (const Connectivity connectivity : {Connectivity::four, Connectivity::eight}) {
      BinaryImage larger = shadow;
      for (double s = 1; s <= 80; s += 1.5) {
        const BinaryImage mask = feature_mask(shadow, s, connectivity);
        EXPECT_EQ(unite(mask, larger), larger) << "s = " << s;
        larger = mask;
      }
    }
  }
}

TEST(FeatureMask, TheSymmetricMaskAddsLitSpotsInShadowWiderThanTheFeatureSize) {
  const BinaryImage small = filled_rectangle(100, 100, 10, 10, 8, 8);
  const BinaryImage large = filled_rectangle(100, 100, 50, 50, 30, 30);
  const BinaryImage shadow = complement(unite(small, large));
  const BinaryImage shadows_only = feature_mask(shadow, 20);
  EXPECT_FALSE(shadows_only.at(65, 65));
  EXPECT_EQ(symmetric_feature_mask(shadow, 20), unite(shadows_only, large));
}

TEST(FeatureMask, OnlyAFullViewOfTheLightIsNotShadow) {
  const std::vector<float> visibility{1.f, 1.f - 1e-7f, 0.996f, 0.5f, 0.f, std::nanf("")};
  const BinaryImage shadow = shadow_of(visibility, 6, 1);
  EXPECT_FALSE(shadow.at(0, 0));
  EXPECT_FALSE(shadow.at(1, 0));
  for (int x = 2; x < 6; ++x) EXPECT_TRUE(shadow.at(x, 0)) << x;
}

TEST(BoxFilter, IsTheMeanOfTheClippedSquareByPixelArea) {
  const Image image = random_image(23, 17, 9);
  for (const double s : {0.5, 1.0, 1.8, 2.0, 5.0, 7.3, 12.0, 60.0}) {
    const Image filtered = box_filter(image, s);
    const double half = std::max(s, 1.0) / 2;
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 23; ++x) {
        double sum = 0, area = 0;
        for (int v = 0; v < 17; ++v)
          for (int u = 0; u < 23; ++u) {
            const auto overlap = [half](int a, int b) {
              return std::max(0.0, std::min(a + half, b + 0.5) - std::max(a - half, b - 0.5));
            };
            const double weight = overlap(x, u) * overlap(y, v);
            sum += weight * image.at(u, v).g;
            area += weight;
          }
        ASSERT_NEAR(filtered.at(x, y).g, sum / area, kRounding) << "s = " << s;
      }
  }
}

TEST(Metric, EqualPicturesHaveNoErrorAtAnySizeAndExponent) {
  const Image image = random_image(80, 60, 1);
  const BinaryImage shadow = random_rectangles(80, 60, 6, 1);
  for (const double p : {1.0, 2.0, 3.5}) {
    const Comparison same = compare(image, image, shadow, at({0.1, 4, 17, 200}, p));
    EXPECT_EQ(same.l1, 0);
    EXPECT_EQ(same.l2, 0);
    for (const ErrorAtSize& e : same.at_sizes) {
      EXPECT_EQ(e.shadows.value, 0);
      EXPECT_EQ(e.symmetric.value, 0);
    }
  }
}

TEST(Metric, VanishingFeatureSizeGivesThePlainNorm) {
  const Image a = random_image(80, 60, 1), b = random_image(80, 60, 50);
  const BinaryImage shadow = random_rectangles(80, 60, 6, 1);
  for (const double p : {1.0, 2.0, 4.0}) {
    const Comparison c = compare(a, b, shadow, at({1e-9, 0.9}, p));
    for (const ErrorAtSize& e : c.at_sizes) {
      EXPECT_NEAR(e.shadows.value, c.lp, kRounding);
      EXPECT_NEAR(e.symmetric.value, c.lp, kRounding);
    }
  }
}

TEST(Metric, IsTheFormulaOfSection22) {
  const int width = 40, height = 30;
  const Image f = random_image(width, height, 1), fh = random_image(width, height, 60);
  const BinaryImage shadow = random_rectangles(width, height, 5, 7);
  const double s = 6;
  const BinaryImage mask = feature_mask(shadow, s);
  const Image f_mean = box_filter(f, s), fh_mean = box_filter(fh, s);
  for (const double p : {1.0, 2.0, 3.0}) {
    double integral = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) {
          const double exact = std::abs(fh.at(x, y)[c] - f.at(x, y)[c]);
          const double mean = std::abs(fh_mean.at(x, y)[c] - f_mean.at(x, y)[c]);
          integral += std::pow(mask.at(x, y) ? exact : mean, p);
        }
    const double expected = std::pow(integral / (3.0 * width * height), 1 / p);
    const Comparison got = compare(f, fh, shadow, at({s}, p));
    EXPECT_NEAR(got.at_sizes[0].shadows.value, expected, 1e-5 * expected) << "p = " << p;
    EXPECT_NEAR(std::pow(got.at_sizes[0].shadows.features, p) +
                    std::pow(got.at_sizes[0].shadows.averages, p),
                std::pow(expected, p), 1e-5)
        << "p = " << p;
  }
}

TEST(Metric, NormsAreThoseOfTheirDefinitions) {
  const Image a(4, 2, Rgb(0.f));
  Image b = a;
  b.at(1, 0) = Rgb(3.f, 0.f, 0.f);
  b.at(2, 1) = Rgb(0.f, 0.f, -4.f);
  const Comparison c = compare(a, b, BinaryImage(4, 2), at({}, 3));
  EXPECT_NEAR(c.l1, 7.0 / 24, kRounding);
  EXPECT_NEAR(c.l2, std::sqrt(25.0 / 24), kRounding);
  EXPECT_NEAR(c.lp, std::cbrt(91.0 / 24), kRounding);
}

TEST(Metric, APictureTiledTwiceHasTheSameErrorPerArea) {
  const Image a = random_image(64, 64, 3), b = random_image(64, 64, 30);
  Image a2(128, 64), b2(128, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) a2.at(x, y) = a.at(x % 64, y), b2.at(x, y) = b.at(x % 64, y);
  EXPECT_NEAR(compare(a, b, BinaryImage(64, 64), {}).l2,
              compare(a2, b2, BinaryImage(128, 64), {}).l2, kRounding);
}

TEST(Metric, AveragedSmallShadowsCostLittleAndAveragedLargeOnesAsMuchAsL2) {
  // A chequerboard of squares 8 px wide, replaced by its mean, at s = 32 and at s = 4.
  BinaryImage shadow(256, 256);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      if (x / 8 % 3 == 0 && y / 8 % 3 == 0) shadow.set(x, y);
  const Image f = picture_of(shadow);
  const Comparison c = compare(f, uniform_mean_of(f), shadow, at({4, 32}));
  EXPECT_NEAR(c.at_sizes[0].shadows.mask_share, static_cast<double>(shadow.count()) / 65536.0,
              1e-12);
  EXPECT_GT(c.at_sizes[0].shadows.value, 0.9 * c.l2);
  EXPECT_EQ(c.at_sizes[1].shadows.mask_share, 0);
  EXPECT_LT(c.at_sizes[1].shadows.value, 0.15 * c.l2);
}

TEST(Metric, IsTheSameBytesForAnyNumberOfThreads) {
  const Image a = random_image(300, 200, 3), b = random_image(300, 200, 30);
  const BinaryImage shadow = random_rectangles(300, 200, 15, 7);
  const CompareOptions options = at({3, 24.5}, 2.5);
  set_thread_count(1);
  const Comparison one = compare(a, b, shadow, options);
  set_thread_count(0);
  const Comparison all = compare(a, b, shadow, options);
  EXPECT_EQ(one.lp, all.lp);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one.at_sizes[i].shadows.value, all.at_sizes[i].shadows.value);
    EXPECT_EQ(one.at_sizes[i].symmetric.value, all.at_sizes[i].symmetric.value);
  }
}

TEST(Metric, PartsAndRegionsAddUpToTheWhole) {
  const Image a = random_image(100, 60, 3), b = random_image(100, 60, 30);
  const BinaryImage shadow =
      unite(filled_rectangle(100, 60, 5, 5, 20, 30), filled_rectangle(100, 60, 60, 20, 12, 12));
  CompareOptions options = at({8});
  options.parts = {{0, 0, 40, 60}, {40, 0, 60, 60}};
  options.worst_regions = 10;
  options.keep_maps = true;
  const Comparison c = compare(a, b, shadow, options);
  const ErrorAtSize& e = c.at_sizes[0];
  EXPECT_NEAR(0.4 * e.parts[0] * e.parts[0] + 0.6 * e.parts[1] * e.parts[1],
              e.shadows.value * e.shadows.value, kRounding);
  EXPECT_NEAR(0.4 * c.parts[0].l1 + 0.6 * c.parts[1].l1, c.l1, kRounding);
  EXPECT_EQ(e.mask, shadow);
  EXPECT_NEAR(norm(e.local, 2), e.shadows.value, kRounding);
  ASSERT_EQ(e.regions.size(), 2u);
  EXPECT_EQ(e.regions[0].region.pixels, 600u);
  EXPECT_EQ(e.regions[1].region.left, 60);
  double features = 0;
  for (const RegionError& r : e.regions)
    features += r.value * r.value * static_cast<double>(r.region.pixels) / 6000;
  EXPECT_NEAR(features, e.shadows.features * e.shadows.features, kRounding);
}

// Appendix A: the closed forms, against the norms of pictures whose shadows differ in size only.
TEST(AveragingError, DependsOnTheMeanVisibilityAlone) {
  for (const int side : {1, 4, 16, 64}) {
    BinaryImage shadow(128, 128);
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) shadow.set(x, y, x / side % 2 == 0 && y / side % 2 == 0);
    const Image v = picture_of(shadow);
    const Comparison c = compare(v, uniform_mean_of(v), shadow, {});
    EXPECT_NEAR(c.l1, averaging_error_l1(0.75), kRounding) << side;
    EXPECT_NEAR(c.l2, averaging_error_l2(0.75), kRounding) << side;
  }
  EXPECT_DOUBLE_EQ(averaging_error_l1(0.5), 0.5);
  EXPECT_DOUBLE_EQ(averaging_error_l2(0.5), 0.5);
  EXPECT_EQ(averaging_error_l1(1), 0);
  EXPECT_EQ(averaging_error_l2(0), 0);
}

TEST(EstimatedShadow, FindsDarkRegionsOnAWallWhoseLightFallsOff) {
  Image wall(300, 200);
  const BinaryImage shadow = unite(filled_rectangle(300, 200, 40, 50, 20, 20),
                                   filled_rectangle(300, 200, 200, 120, 60, 40));
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) {
      const float dx = static_cast<float>(x - 150) / 600.f,
                  dy = static_cast<float>(y - 100) / 600.f;
      const float cosine2 = 1 / (1 + dx * dx + dy * dy);
      wall.at(x, y) = Rgb(cosine2 * cosine2 * (shadow.at(x, y) ? 0.3f : 1.f));
    }
  EXPECT_EQ(estimate_shadow(wall), shadow);
}

}  // namespace
}  // namespace halflight
