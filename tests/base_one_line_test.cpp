#include <gtest/gtest.h>

#include "halflight/base/one_line.h"
#include "halflight/base/result.h"

namespace halflight {
namespace {

TEST(OneLine, LeavesNothingThatMovesTheCursor) {
  EXPECT_EQ(one_line("Wood\n\x1b[2J\tdark"), "Wood  [2J dark");
  EXPECT_EQ(one_line("M\xc3\xb6"
                     "bel"),
            "M\xc3\xb6"
            "bel");
}

TEST(OneLine, IsCutBetweenCharacters) {
  EXPECT_EQ(one_line("abcdef", 6), "abcdef");
  EXPECT_EQ(one_line("abcdefg", 6), "abcdef...");
  EXPECT_EQ(one_line("abcd\xe2\x82\xac"
                     "fg",
                     6),
            "abcd...");
  EXPECT_EQ(one_line("\x80\x80\x80", 1), "...");
}

TEST(OneLine, EveryErrorIsOne) {
  const Error error = system_error("no\nsuch", "a\rb", "mend\tit").value();
  EXPECT_EQ(error.line(), "a b: no such (mend it)");
  EXPECT_EQ(error.kind, Error::Kind::system);
  EXPECT_LT(input_error(std::string(5000, 'x')).value().line().size(), 400u);
}

}  // namespace
}  // namespace halflight
