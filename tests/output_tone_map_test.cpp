#include <gtest/gtest.h>

#include "halflight/output/tone_map.h"

namespace halflight {
namespace {

constexpr ToneMap kAll[] = {ToneMap::none, ToneMap::filmic, ToneMap::agx, ToneMap::neutral};

TEST(ToneMaps, RiseFromBlackToWhiteWithoutTint) {
  for (const ToneMap map : kAll) {
    EXPECT_NEAR(tone_mapped(map, Rgb(0.f)).g, 0.f, 1e-4f);
    float last = -1e-6f;
    for (float x = 1e-3f; x < 1e3f; x *= 1.1f) {
      const Rgb c = tone_mapped(map, Rgb(x));
      EXPECT_GE(c.g, last) << "map " << static_cast<int>(map) << " at " << x;
      EXPECT_LE(c.g, 1.f);
      EXPECT_NEAR(c.r, c.g, 1e-5f);
      EXPECT_NEAR(c.b, c.g, 1e-5f);
      last = c.g;
    }
    EXPECT_GT(last, 0.97f);
  }
}

TEST(ToneMaps, NoneClampsOnly) {
  EXPECT_EQ(tone_mapped(ToneMap::none, Rgb(0.3f, 2.f, -1.f)), Rgb(0.3f, 1.f, 0.f));
}

TEST(ToneMaps, FilmicMeetsThePublishedCurve) {
  // Narkowicz 2015: f(1) = 2.54 / 3.16.
  EXPECT_NEAR(tone_mapped(ToneMap::filmic, Rgb(1.f)).g, 0.8038f, 1e-4f);
}

TEST(ToneMaps, NeutralKeepsBaseColoursLessTheFresnelOffset) {
  // Below 0.8 only the 0.04 reflected by every glossy surface is taken off.
  const Rgb c = tone_mapped(ToneMap::neutral, Rgb(0.7f, 0.4f, 0.2f));
  EXPECT_NEAR(c.r, 0.66f, 1e-6f);
  EXPECT_NEAR(c.g, 0.36f, 1e-6f);
  EXPECT_NEAR(c.b, 0.16f, 1e-6f);
}

TEST(ToneMaps, AgxBringsMiddleGreyToItsPivot) {
  // 0.18 lies 10 of 16.5 stops up the log range: the pivot, encoded as 0.5 and shown as 0.5^2.2.
  EXPECT_NEAR(tone_mapped(ToneMap::agx, Rgb(0.18f)).g, std::pow(0.5f, 2.2f), 2e-3f);
}

TEST(ToneMaps, AgxFadesBrightColoursTowardsWhite) {
  const Rgb c = tone_mapped(ToneMap::agx, Rgb(200.f, 0.1f, 0.1f));
  EXPECT_GT(c.g, 0.5f);
  EXPECT_GT(c.r, c.g);
}

TEST(Exposure, AutomaticBringsTheLogAverageToMiddleGreyAndIgnoresBlack) {
  Image image(4, 1);
  image.pixels = {Rgb(1.f), Rgb(4.f), Rgb(0.f), Rgb(2.f)};  // log average 2
  EXPECT_NEAR(std::exp2(automatic_ev(image)) * 2.f, 0.18f, 1e-5f);
  EXPECT_EQ(automatic_ev(Image(2, 2)), 0.f);
  EXPECT_NEAR(developed(image, 1.f, ToneMap::none).pixels[2].g, 0.f, 0.f);
  EXPECT_NEAR(developed(image, -3.f, ToneMap::none).pixels[1].g, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace halflight
