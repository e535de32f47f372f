#include <gtest/gtest.h>

#include "halflight/base/quantities.h"

namespace halflight {
namespace {

TEST(Quantities, LengthsAreMetres) {
  EXPECT_DOUBLE_EQ(*parse_length("0.05"), 0.05);
  EXPECT_DOUBLE_EQ(*parse_length("5cm"), 0.05);
  EXPECT_DOUBLE_EQ(*parse_length("2in"), 0.0508);
  EXPECT_DOUBLE_EQ(*parse_length("0"), 0.0);
}

TEST(Quantities, DurationsAreSecondsAndPercentagesShares) {
  EXPECT_DOUBLE_EQ(*parse_duration("2m"), 120.0);
  EXPECT_DOUBLE_EQ(*parse_duration("500ms"), 0.5);
  EXPECT_DOUBLE_EQ(*parse_percent("5%"), 0.05);
  EXPECT_DOUBLE_EQ(*parse_count("250k"), 250000.0);
}

TEST(Quantities, NonsenseIsNamedInTheError) {
  for (const char* bad :
       {"", "cm", "-5cm", "5 cm", "nan", "inf", "5furlong", "1e999", "1e39", "1e39m"}) {
    const auto length = parse_length(bad);
    ASSERT_FALSE(length) << bad;
    EXPECT_NE(length.error().line().find(bad), std::string::npos);
    EXPECT_FALSE(length.error().remedy.empty());
  }
}

}  // namespace
}  // namespace halflight
