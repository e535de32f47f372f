// halflight compare and reproduce as a user meets them: files in, numbers, pictures and exit status
// out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "features_fixtures.h"
#include "halflight/features/compare.h"
#include "halflight/features/feature_mask.h"
#include "halflight/io/image_read.h"
#include "halflight/io/image_write.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

constexpr double kFloat = 1e-6;  // of values of order 1 that were stored as floats

class CompareCommand : public testing::Test {
 protected:
  struct Outcome {
    int status = -1;
    std::string out, errors;
  };
  Outcome halflight(const std::string& arguments) const {
    const std::string line = "cd '" + folder_.path().string() + "' && '" HALFLIGHT_BINARY "' " +
                             arguments + " >out.txt 2>errors.txt";
    const int status = std::system(line.c_str());
    return {WEXITSTATUS(status), text("out.txt"), text("errors.txt")};
  }
  std::string text(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void save(const std::string& name, const Image& image) const {
    ASSERT_TRUE(write_image(path(name), image).has_value());
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  const TemporaryFolder folder_;

  const BinaryImage shadow_ = unite(test::filled_rectangle(96, 64, 10, 10, 8, 8),
                                    test::filled_rectangle(96, 64, 40, 20, 30, 25));
  Image reference() const {
    Image image = test::random_image(96, 64, 4);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) image.at(x, y) *= shadow_.at(x, y) ? 0.1f : 1.f;
    return image;
  }
  Image visibility() const {
    Image image(96, 64, Rgb(1.f));
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x)
        if (shadow_.at(x, y)) image.at(x, y) = Rgb(0.5f);
    return image;
  }
};

TEST_F(CompareCommand, PrintsTheMetricOfEveryFeatureSizeAsJson) {
  const Image test = test::random_image(96, 64, 40);
  save("ref.exr", reference());
  save("test.exr", test);
  save("visibility.png", visibility());
  const Outcome ran = halflight(
      "compare ref.exr test.exr --feature-size 4 --feature-size 20.5 "
      "--visibility-mask visibility.png --json --part 0,0,48,64 --worst 1");
  ASSERT_EQ(ran.status, 0) << ran.errors;
  EXPECT_EQ(ran.errors, "");
  CompareOptions options;
  options.feature_sizes = {4, 20.5};
  const Comparison expected = compare(reference(), test, shadow_, options);
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_NEAR(json["l1"], expected.l1, kFloat);
  EXPECT_NEAR(json["l2"], expected.l2, kFloat);
  ASSERT_EQ(json["fbem"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(json["fbem"][i]["feature_size"], options.feature_sizes[i]);
    EXPECT_NEAR(json["fbem"][i]["value"], expected.at_sizes[i].shadows.value, kFloat);
    EXPECT_NEAR(json["fbem"][i]["symmetric"], expected.at_sizes[i].symmetric.value, kFloat);
    EXPECT_EQ(json["fbem"][i]["parts"].size(), 1u);
  }
  EXPECT_EQ(json["fbem"][1]["regions"][0]["pixels"], 750);
  EXPECT_GT(json["parts"][0]["l2"], 0);
}

TEST_F(CompareCommand, EqualPicturesHaveNoErrorAndShadowsAreEstimatedWithAWord) {
  save("a.png", reference());
  const Outcome ran = halflight("compare a.png a.png --feature-size 12 --json");
  ASSERT_EQ(ran.status, 0) << ran.errors;
  EXPECT_THAT(ran.errors, ::testing::HasSubstr("--visibility-mask"));
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["l2"], 0);
  EXPECT_EQ(json["fbem"][0]["value"], 0);
}

TEST_F(CompareCommand, WritesMaskDifferenceAndFalseColourOfEverySize) {
  save("ref.exr", reference());
  save("test.exr", test::random_image(96, 64, 40));
  save("visibility.exr", visibility());
  const Outcome ran = halflight(
      "compare ref.exr test.exr --feature-size 4 --feature-size 20 --visibility-mask "
      "visibility.exr --mask mask.png --difference difference.exr --false-colour error.png");
  ASSERT_EQ(ran.status, 0) << ran.errors;
  const auto mask = read_float_image(path("mask-20.png"));
  ASSERT_TRUE(mask.has_value()) << mask.error().line();
  const BinaryImage expected = feature_mask(shadow_, 20);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) ASSERT_EQ(mask->at(x, y).g == 0.f, expected.at(x, y));
  const auto difference_file = read_float_image(path("difference.exr"));
  ASSERT_TRUE(difference_file.has_value());
  EXPECT_EQ(difference_file->pixels,
            difference(reference(), test::random_image(96, 64, 40)).pixels);
  EXPECT_TRUE(read_float_image(path("mask-4.png")).has_value());
  EXPECT_TRUE(read_float_image(path("error-4.png")).has_value());
  EXPECT_TRUE(read_float_image(path("error-20.png")).has_value());
}

TEST_F(CompareCommand, BadInputEndsWithStatus1AndOneLineThatNamesTheFile) {
  save("a.png", reference());
  save("small.png", Image(10, 10, Rgb(1.f)));
  Image broken = reference();
  broken.at(7, 3).g = std::numeric_limits<float>::quiet_NaN();
  save("broken.exr", broken);
  folder_.write("text.png", "no picture");
  const std::pair<const char*, const char*> cases[] = {
      {"compare a.png small.png --feature-size 4", "small.png"},
      {"compare a.png broken.exr", "(7, 3)"},
      {"compare a.png text.png", "text.png"},
      {"compare a.png missing.png", "missing.png"},
      {"compare a.png a.png --visibility-mask small.png --feature-size 4", "small.png"},
      {"compare a.png a.png --part 90,0,20,20", "90,0,20,20"},
      {"compare a.png a.png --mask mask.bmp --feature-size 4", "mask.bmp"},
      {"compare a.png a.png --feature-size -3", "feature-size"},
      {"compare a.png a.png --feature-size nan", "feature-size"},
      {"compare a.png a.png --exponent nan", "exponent"},
      {"compare a.png a.png --feature-size 4 --worst -1", "worst"},
      {"compare a.png a.png --feature-size 4 --worst 99999999999999999999", "worst"},
      {"compare a.png a.png --worst 3", "feature-size"},
      {"compare a.png a.png --difference ''", "difference"},
      {"reproduce figure99 -o out", "figure99"},
  };
  for (const auto& [arguments, named] : cases) {
    const Outcome ran = halflight(arguments);
    EXPECT_EQ(ran.status, 1) << arguments;
    EXPECT_EQ(ran.out, "") << arguments;
    EXPECT_THAT(ran.errors, ::testing::HasSubstr(named)) << arguments;
  }
}

TEST_F(CompareCommand, ReproduceWritesOneSelfContainedPage) {
  const Outcome ran = halflight("reproduce figure2 figure4 -o report");
  ASSERT_EQ(ran.status, 0) << ran.errors;
  const std::string page = text("report/report.html");
  EXPECT_THAT(page, ::testing::HasSubstr("<section id=\"figure2\">"));
  EXPECT_THAT(page, ::testing::HasSubstr("src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("src=\"figure")));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("http")));
  EXPECT_THAT(text("report/report.md"), ::testing::HasSubstr("](figure4-mask-1-12.png)"));
  EXPECT_TRUE(read_float_image(path("report/figure4-mask-1-12.png")).has_value());
  const auto numbers = nlohmann::json::parse(text("report/numbers.json"));
  EXPECT_EQ(numbers["figure4"].size(), 16u);
}

}  // namespace
}  // namespace halflight
