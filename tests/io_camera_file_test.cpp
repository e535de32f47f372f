#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "halflight/io/camera_file.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

Result<View> parse(const std::string& text) { return parse_camera(text, Mat4(1.0), "camera.json"); }

TEST(CameraFile, LooksFromAPositionToATarget) {
  const auto view = parse(
      R"({"camera": {"position": [1, 2, 3], "target": [1, 2, 0], "up": [0, 5, 0], "fov_y_deg": 90}})");
  ASSERT_TRUE(view) << view.error().line();
  EXPECT_EQ(view->camera.position, Vec3(1.f, 2.f, 3.f));
  EXPECT_EQ(view->camera.forward, Vec3(0.f, 0.f, -1.f));
  EXPECT_EQ(view->camera.up, Vec3(0.f, 1.f, 0.f));
  EXPECT_FLOAT_EQ(view->camera.vertical_fov, kPi / 2.f);
}

// Squares of such lengths are infinite or 0 in single precision.
TEST(CameraFile, LengthsThatHaveNoSquareAreRefused) {
  for (const char* forward : {"[0, 0, -3.4e38]", "[1e-30, 0, 0]", "[0, 0, 0]", "[1e300, 0, 0]"}) {
    const auto view = parse(std::string(R"({"position": [0, 0, 0], "forward": )") + forward + "}");
    ASSERT_FALSE(view) << forward;
    EXPECT_THAT(view.error().line(), HasSubstr("no direction"));
  }
  EXPECT_FALSE(parse(R"({"position": [-3e38, 0, 0], "target": [3e38, 0, 0]})"));
  const auto small = parse(R"({"position": [0, 0, 0], "forward": [0, 1e-12, 0]})");
  ASSERT_TRUE(small) << small.error().line();
  EXPECT_FLOAT_EQ(small->camera.forward.y, 1.f);
}

TEST(CameraFile, NonsenseIsNamed) {
  EXPECT_THAT(parse("[1]").error().line(), HasSubstr("not a camera"));
  EXPECT_THAT(
      parse(R"({"position": [0, 0, 0], "forward": [0, 0, 1], "fov_y_deg": 180})").error().line(),
      HasSubstr("between 0 and 180"));
}

}  // namespace
}  // namespace halflight
