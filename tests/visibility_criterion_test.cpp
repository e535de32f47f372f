// When a cluster may stand for its contents, against shadows drawn by their tangents.
#include "halflight/visibility/criterion.h"

#include <gtest/gtest.h>

namespace halflight {
namespace {

TEST(UmbraWidth, OfAPointGrowsWithTheDistanceByTheInterceptTheorem) {
  EXPECT_FLOAT_EQ(umbra_width(0.5f, 0.f, 2.f, 6.f), 0.5f * 8.f / 2.f);
}

TEST(UmbraWidth, EndsWhereTheTangentsOfAWiderEmitterMeet) {
  // The lines from the ends of an emitter of 3 m past a blocker of 1 m, 4 m away, meet 2 m beyond.
  EXPECT_FLOAT_EQ(umbra_width(1.f, 3.f, 4.f, 0.f), 1.f);
  EXPECT_FLOAT_EQ(umbra_width(1.f, 3.f, 4.f, 1.f), 0.5f);
  EXPECT_FLOAT_EQ(umbra_width(1.f, 3.f, 4.f, 2.f), 0.f);
  EXPECT_LT(umbra_width(1.f, 3.f, 4.f, 3.f), 0.f);
}

// Distances as shares of the way to the emitter.
TEST(StopRule, StopsAtBlockersWhoseUmbraIsAsWideAsTheFeatureSize) {
  constexpr float kReach = 7.f;
  for (const float s : {0.1f, 0.5f})
    for (const float emitter : {0.f, 0.1f, 2.f})
      for (const float share : {0.1f, 0.5f, 0.8f}) {
        const float d2 = share * kReach, d1 = kReach - d2;
        const float blocker = StopRule::between(s, emitter).largest_blocker(share);
        EXPECT_NEAR(umbra_width(blocker, emitter, d1, d2), s, 1e-5f)
            << s << " " << emitter << " " << share;
      }
}

TEST(StopRule, UnderTheSunAllowsMoreTheFartherTheBlocker) {
  // An umbra loses the sun's angle times the distance.
  EXPECT_FLOAT_EQ(StopRule::widening(0.1f, 0.0093f).largest_blocker(10.f), 0.1f + 0.093f);
  EXPECT_LT(StopRule::never().largest_blocker(1e9f), 0.f);
}

}  // namespace
}  // namespace halflight
