#include <gtest/gtest.h>

#include "halflight/io/feature_size_rules.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

class FeatureSizeRules : public ::testing::Test {
 protected:
  auto read(const std::string& text) {
    folder_.write("rules.toml", text);
    return read_feature_size_rules(folder_.path() / "rules.toml");
  }
  TemporaryFolder folder_;
};

TEST_F(FeatureSizeRules, AreReadInOrder) {
  const auto rules = read(
      "[[rule]]\nmaterial = \"Floor*\"\nfeature-size = \"2cm\"\n"
      "[[rule]]\nnode = \"Desk\"\nmaterial = \"Wood\"\nfeature-size = 0.5\n");
  ASSERT_TRUE(rules) << rules.error().line();
  ASSERT_EQ(rules->size(), 2u);
  EXPECT_EQ((*rules)[0].material, "Floor*");
  EXPECT_EQ((*rules)[0].node, "");
  EXPECT_FLOAT_EQ((*rules)[0].feature_size, 0.02f);
  EXPECT_EQ((*rules)[1].node, "Desk");
  EXPECT_FLOAT_EQ((*rules)[1].feature_size, 0.5f);
}

TEST_F(FeatureSizeRules, NonsenseIsNamedWithItsLine) {
  for (const auto& [text, what] : std::initializer_list<std::pair<const char*, const char*>>{
           {"rule = 3\n", "line 1"},
           {"[[rule]]\nmaterial = \"a\"\n", "no feature-size"},
           {"[[rule]]\nfeature-size = \"2cm\"\n", "neither material nor node"},
           {"[[rule]]\nmaterial = \"a\"\nfeature-size = \"2 furlongs\"\n", "line 3"},
           {"[[rule]]\nmaterial = \"a\"\nfeature-size = -1\n", "line 3"},
           {"[[rule]]\nmaterial = \"a\"\nfeature-size = nan\n", "line 3"},
           {"[[rule]]\nmaterial = \"a\"\nfeature-size = 1e300\n", "line 3"},
           {"[[rule]]\nmaterial = \"a\"\nfeature-size = \"1e39m\"\n", "line 3"},
           {"[[rule]]\nmaterial = 4\nfeature-size = 1\n", "line 2"},
           {"[[rule]]\nmaterail = \"a\"\nfeature-size = 1\n", "materail"},
           {"[[rule\n", "line 1"},
           {"# \xc3\xa9\nna\xc3\xafve = 1\n", "line 2"},
           {"[[rule]]\nmaterial = \xc3\xa9\n", "line 2"},
           {"\xff\xfe", "line 1"}}) {
    const auto rules = read(text);
    ASSERT_FALSE(rules) << text;
    EXPECT_NE(rules.error().line().find(what), std::string::npos) << rules.error().line();
    EXPECT_NE(rules.error().line().find("rules.toml"), std::string::npos) << rules.error().line();
  }
}

// Tables in tables end by recursion, and the stack has an end.
TEST_F(FeatureSizeRules, DeepKeysAreRefused) {
  std::string key = "a";
  for (int i = 0; i < 300'000; ++i) key += ".a";
  for (const std::string& text :
       {key + " = 1\n", "\n[" + key + "]\n", "x = {" + key + " = 1}\n", "\"#\"." + key + " = 1\n",
        "['#'." + key + "]\n", "x = {y = \"\"\"\n# \"\"\", " + key + " = 1}\n"}) {
    const auto rules = read(text);
    ASSERT_FALSE(rules);
    EXPECT_NE(rules.error().what.find("too many dots"), std::string::npos) << rules.error().line();
  }
  EXPECT_TRUE(
      read("# . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . . .\n"
           "[[rule]] # " +
           std::string(100, '.') + "\nmaterial = \"Wood.001\"\nfeature-size = 0.5\n"));
}

TEST_F(FeatureSizeRules, TooLongOrTooManyAreRefused) {
  const auto rule = [](std::size_t letters) {
    return "[[rule]]\nnode = \"" + std::string(letters, 'a') + "\"\nfeature-size = 0.5\n";
  };
  EXPECT_TRUE(read(rule(kLongestRuleName)));
  const auto longer = read(rule(kLongestRuleName + 1));
  ASSERT_FALSE(longer);
  EXPECT_NE(longer.error().what.find("node is longer than 255 bytes, line 2"), std::string::npos);
  std::string many;
  for (std::size_t i = 0; i < kMostRules; ++i) many += rule(1);
  EXPECT_TRUE(read(many));
  const auto more = read(many + rule(1));
  ASSERT_FALSE(more);
  EXPECT_NE(more.error().what.find("more than 1024 rules, line 3073"), std::string::npos)
      << more.error().line();
}

TEST_F(FeatureSizeRules, MissingFileIsAnError) {
  EXPECT_FALSE(read_feature_size_rules(folder_.path() / "none.toml"));
}

}  // namespace
}  // namespace halflight
