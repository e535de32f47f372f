// OpenCV as an independent oracle for binary morphology, distances, regions and box filters.
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "features_fixtures.h"
#include "halflight/features/box_filter.h"
#include "halflight/features/distance_transform.h"
#include "halflight/features/morphology.h"
#include "halflight/features/regions.h"

namespace halflight {
namespace {

cv::Mat to_mat(const BinaryImage& image) {
  cv::Mat mat(image.height(), image.width(), CV_8U);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) mat.at<std::uint8_t>(y, x) = image.at(x, y) ? 255 : 0;
  return mat;
}

bool same(const BinaryImage& image, const cv::Mat& mat) {
  return cv::countNonZero(to_mat(image) != mat) == 0;
}

cv::Mat element(Connectivity connectivity) {
  return cv::getStructuringElement(
      connectivity == Connectivity::eight ? cv::MORPH_RECT : cv::MORPH_CROSS, {3, 3});
}

class OpenCv : public testing::TestWithParam<Connectivity> {};
INSTANTIATE_TEST_SUITE_P(Connectivity, OpenCv,
                         testing::Values(Connectivity::four, Connectivity::eight),
                         [](const auto& instance) {
                           return instance.param == Connectivity::four ? "four" : "eight";
                         });

TEST_P(OpenCv, ErosionExpansionAndOpeningAgree) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const int n : {1, 2, 5, 16, 33}) {
      const BinaryImage image = complement(test::random_rectangles(257, 190, 7, seed));
      cv::Mat eroded, expanded, opened;
      cv::erode(to_mat(image), eroded, element(GetParam()), {-1, -1}, n);
      cv::dilate(to_mat(image), expanded, element(GetParam()), {-1, -1}, n);
      cv::morphologyEx(to_mat(image), opened, cv::MORPH_OPEN, element(GetParam()), {-1, -1}, n);
      EXPECT_TRUE(same(erode(image, n, GetParam()), eroded)) << seed << ", n = " << n;
      EXPECT_TRUE(same(expand(image, n, GetParam()), expanded)) << seed << ", n = " << n;
      EXPECT_TRUE(same(opening(image, n, GetParam()), opened)) << seed << ", n = " << n;
    }
}

TEST_P(OpenCv, ErosionFromAClearOutsideAgrees) {
  const BinaryImage image = complement(test::random_rectangles(140, 99, 5, 11));
  for (const int n : {1, 6, 19}) {
    cv::Mat eroded;
    cv::erode(to_mat(image), eroded, element(GetParam()), {-1, -1}, n, cv::BORDER_CONSTANT, {0});
    EXPECT_TRUE(same(erode(image, n, GetParam(), Outside::clear), eroded)) << n;
  }
}

TEST_P(OpenCv, DistancesAgree) {
  const BinaryImage image = complement(test::random_rectangles(211, 120, 6, 4));
  cv::Mat expected;
  cv::distanceTransform(to_mat(image), expected,
                        GetParam() == Connectivity::eight ? cv::DIST_C : cv::DIST_L1, 3);
  const auto distance = distance_to_clear(image, GetParam(), Outside::ignored);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 211; ++x)
      ASSERT_EQ(static_cast<float>(distance[static_cast<std::size_t>(y * 211 + x)]),
                expected.at<float>(y, x));
}

TEST_P(OpenCv, RegionsAgree) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const BinaryImage image = test::random_bits(130, 110, 0.45f, seed);
    cv::Mat labels, stats, centroids;
    const int count = cv::connectedComponentsWithStats(to_mat(image), labels, stats, centroids,
                                                       GetParam() == Connectivity::eight ? 8 : 4);
    const Regions found = connected_regions(image, GetParam());
    ASSERT_EQ(found.regions.size(), static_cast<std::size_t>(count - 1));
    for (int y = 0; y < 110; ++y)
      for (int x = 0; x < 130; ++x) {
        const std::uint32_t label = found.label[static_cast<std::size_t>(y * 130 + x)];
        const int theirs = labels.at<int>(y, x);
        ASSERT_EQ(label == 0, theirs == 0);
        if (label == 0) continue;
        const Region& r = found.regions[label - 1];
        ASSERT_EQ(r.left, stats.at<int>(theirs, cv::CC_STAT_LEFT));
        ASSERT_EQ(r.top, stats.at<int>(theirs, cv::CC_STAT_TOP));
        ASSERT_EQ(r.width, stats.at<int>(theirs, cv::CC_STAT_WIDTH));
        ASSERT_EQ(r.height, stats.at<int>(theirs, cv::CC_STAT_HEIGHT));
        ASSERT_EQ(r.pixels, static_cast<std::size_t>(stats.at<int>(theirs, cv::CC_STAT_AREA)));
      }
  }
}

TEST(OpenCvFilter, OddBoxesAgreeUpToTheBorder) {
  const Image image = test::random_image(97, 64, 2);
  cv::Mat values(64, 97, CV_32FC3), ones(64, 97, CV_32F, cv::Scalar(1));
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 97; ++x) {
      const Rgb& c = image.at(x, y);
      values.at<cv::Vec3f>(y, x) = {c.r, c.g, c.b};
    }
  for (const int size : {3, 9, 41}) {
    cv::Mat sum, covered;  // clipped at the border: sum of what is inside over its count
    cv::boxFilter(values, sum, CV_64F, {size, size}, {-1, -1}, false, cv::BORDER_CONSTANT);
    cv::boxFilter(ones, covered, CV_64F, {size, size}, {-1, -1}, false, cv::BORDER_CONSTANT);
    const Image filtered = box_filter(image, size);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 97; ++x)
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(filtered.at(x, y)[c], sum.at<cv::Vec3d>(y, x)[c] / covered.at<double>(y, x),
                      1e-5);
  }
}

}  // namespace
}  // namespace halflight
