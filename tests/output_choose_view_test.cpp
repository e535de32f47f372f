#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "halflight/output/choose_view.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

class ChooseView : public ::testing::Test {
 protected:
  ChooseView() {
    for (const char* name : {"door", "window"}) {
      PlacedCamera camera;
      camera.name = name;
      camera.position.x = static_cast<float>(geometry_.cameras.size()) + 1.f;
      geometry_.cameras.push_back(camera);
    }
    // Centimetres, z up.
    scene_.to_world = Mat4(glm::dvec4(.01, 0, 0, 0), glm::dvec4(0, 0, -.01, 0),
                           glm::dvec4(0, .01, 0, 0), glm::dvec4(0, 0, 0, 1));
  }
  Result<View> choose(const std::string& wish) const {
    return choose_view(wish, scene_, geometry_, [] {
      PlacedCamera camera;
      camera.position.x = 99.f;
      return camera;
    });
  }
  static bool near(const Vec3& a, const Vec3& b) { return glm::distance(a, b) < 1e-5f; }

  TemporaryFolder folder_;
  Scene scene_;
  Geometry geometry_;
};

TEST_F(ChooseView, TakesCamerasByNameAndIndex) {
  EXPECT_EQ(choose("window")->camera.position.x, 2.f);
  EXPECT_EQ(choose("0")->camera.position.x, 1.f);
  const auto unknown = choose("roof");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().line(), HasSubstr("0 'door', 1 'window'"));
  EXPECT_FALSE(choose("2"));
}

TEST_F(ChooseView, AutoPrefersACameraOfTheScene) {
  EXPECT_EQ(choose("auto")->camera.position.x, 1.f);
  geometry_.cameras.clear();
  EXPECT_EQ(choose("auto")->camera.position.x, 99.f);
}

TEST_F(ChooseView, ACameraThatCannotLookIsAnError) {
  geometry_.cameras[0].forward = Vec3(0.f);
  EXPECT_THAT(choose("door").error().line(), HasSubstr("'door' has no direction"));
  EXPECT_FALSE(choose("0"));
  EXPECT_EQ(choose("auto")->camera.position.x, 2.f);
  geometry_.cameras[1].position.x = 2e18f;
  EXPECT_FALSE(choose("window"));
  EXPECT_EQ(choose("auto")->camera.position.x, 99.f);
  EXPECT_FALSE(choose("1e18,0,0,0,0,0,45"));
  EXPECT_TRUE(choose("1e10,0,0,0,0,0,45"));  // centimetres
}

TEST_F(ChooseView, NamesOfTheFileLeaveMessagesOneLine) {
  geometry_.cameras[0].name = "do\nor\x1b[31m" + std::string(5000, 'x');
  const std::string line = choose("roof").error().line();
  EXPECT_EQ(line.find_first_of("\n\x1b"), std::string::npos);
  EXPECT_LT(line.size(), 1000u);
}

TEST_F(ChooseView, NumbersAreInTheCoordinatesOfTheFile) {
  const auto view = choose("100,200,300,100,200,400,60");
  ASSERT_TRUE(view);
  EXPECT_TRUE(near(view->camera.position, {1.f, 3.f, -2.f}));
  EXPECT_TRUE(near(view->camera.forward, {0.f, 1.f, 0.f}));
  EXPECT_NEAR(view->camera.vertical_fov, kPi / 3.f, 1e-6f);
  EXPECT_THAT(choose("1,2,3").error().line(), HasSubstr("6 or 7 numbers"));
  EXPECT_FALSE(choose("1,2,3,1,2,3"));
  EXPECT_FALSE(choose("1,2,3,4,5,6,180"));
}

TEST_F(ChooseView, PicturesAreAsWideAsUsualAndOfBoundedHeight) {
  using Size = std::pair<int, int>;
  const auto size_at = [](float aspect) {
    View view;
    view.camera.aspect = aspect;
    return picture_size(view);
  };
  EXPECT_EQ(size_at(0.f), Size(1280, 720));
  EXPECT_EQ(size_at(16.f / 9.f), Size(1280, 720));
  EXPECT_EQ(size_at(0.5f), Size(1280, 2560));
  for (const float narrow : {1e-6f, 1e-30f, 1e-40f}) EXPECT_EQ(size_at(narrow), Size(1280, 5120));
  EXPECT_EQ(size_at(1e30f), Size(1280, 1));
  View asked;
  asked.width = 640;
  asked.height = 320;
  EXPECT_EQ(picture_size(asked), Size(640, 320));
}

TEST_F(ChooseView, ReadsCameraFiles) {
  const auto file =
      folder_.write("view.json", R"({"camera": {"position": [0, 0, 100], "forward": [0, 5, 0],
      "up": [0, 0, 1], "fov_y_deg": 90, "width": 640, "height": 320}})");
  const auto view = choose(file.string());
  ASSERT_TRUE(view) << view.error().line();
  EXPECT_TRUE(near(view->camera.position, {0.f, 1.f, 0.f}));
  EXPECT_TRUE(near(view->camera.forward, {0.f, 0.f, -1.f}));
  EXPECT_TRUE(near(view->camera.up, {0.f, 1.f, 0.f}));
  EXPECT_EQ(view->width, 640);
  EXPECT_EQ(view->camera.aspect, 2.f);

  for (const char* bad : {"", "[]", "{}", R"({"position": [0, 0], "forward": [0, 0, 1]})",
                          R"({"position": [0, 0, 1], "forward": [0, 0, 0]})",
                          R"({"position": [0, 0, 1], "target": [0, 0, 0], "fov_y_deg": -4})"}) {
    const auto refused = choose(folder_.write("bad.json", bad).string());
    ASSERT_FALSE(refused) << bad;
    EXPECT_THAT(refused.error().line(), HasSubstr("bad.json"));
  }
}

}  // namespace
}  // namespace halflight
