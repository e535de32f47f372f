#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "halflight/io/image_read.h"
#include "halflight/io/image_write.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

class ImageFiles : public ::testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
};

Image gradient(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = Rgb(static_cast<float>(x) / static_cast<float>(width),
                           static_cast<float>(y) / static_cast<float>(height), 0.25f);
  return image;
}

TEST_F(ImageFiles, ExrKeepsEveryFloat) {
  Image image = gradient(17, 5);
  image.at(3, 2) = Rgb(1e-20f, 123456.78f, -3.f);
  ASSERT_TRUE(write_image(path("a.exr"), image));
  const auto back = read_float_image(path("a.exr"));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->width, 17);
  EXPECT_EQ(back->height, 5);
  EXPECT_EQ(back->pixels, image.pixels);
}

// OpenEXR would take two gigabytes for it.
TEST_F(ImageFiles, ExrAttributesMustLieInTheFile) {
  using namespace std::string_literals;
  ASSERT_TRUE(write_image(path("a.exr"), gradient(17, 5)));
  const Bytes good = *read_file(path("a.exr"));
  const auto error_of = [](const Bytes& bytes) {
    const auto image = decode_float_image(bytes, "a.exr");
    return image ? "" : image.error().line();
  };
  ASSERT_EQ(error_of(good), "");
  const std::string type = "chlist\0"s;
  const auto at = std::search(good.begin(), good.end(), type.begin(), type.end()) - good.begin();
  for (const std::uint8_t highest : {0x7f, 0xff}) {
    Bytes bad = good;
    bad[static_cast<std::size_t>(at) + type.size() + 3] = highest;
    EXPECT_THAT(error_of(bad), HasSubstr("a.exr: an attribute of the EXR picture reaches beyond"));
  }
  for (std::size_t n = 4; n < good.size(); ++n)
    EXPECT_NE(error_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)}), "");
  // The second part of two.
  const std::string parts =
      "\x76\x2f\x31\x01\x02\x10\0\0a\0int\0\x04\0\0\0data\0b\0int\0\xff\xff\xff\x7f\0\0"s;
  EXPECT_THAT(error_of({parts.begin(), parts.end()}), HasSubstr("reaches beyond"));
}

TEST_F(ImageFiles, PngHoldsSrgbOfTheClampedValues) {
  Image image(3, 1);
  // IEC 61966-2-1: linear 0.2158605 is encoded as 128 / 255, 0.001 as 0.0129.
  image.pixels = {Rgb(0.2158605f), Rgb(-1.f, 2.f, std::nanf("")), Rgb(0.001f)};
  ASSERT_TRUE(write_image(path("a.png"), image));
  const auto stored = read_float_image(path("a.png"), PngValues::as_stored);
  ASSERT_TRUE(stored) << stored.error().line();
  EXPECT_EQ(stored->at(0, 0), Rgb(128.f / 255.f));
  EXPECT_EQ(stored->at(1, 0), Rgb(0.f, 1.f, 0.f));
  EXPECT_EQ(stored->at(2, 0), Rgb(3.f / 255.f));
}

TEST_F(ImageFiles, PngReadBackIsLinearWithinHalfAStep) {
  const Image image = gradient(40, 30);
  ASSERT_TRUE(write_image(path("a.png"), image));
  const auto back = read_float_image(path("a.png"));
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(srgb_from_linear(back->pixels[i][k]), srgb_from_linear(image.pixels[i][k]),
                  0.51f / 255.f);
}

TEST_F(ImageFiles, DamagedAndForeignFilesAreErrorsThatNameTheFile) {
  Image image = gradient(64, 64);
  for (const std::string name : {"a.png", "a.exr"}) {
    ASSERT_TRUE(write_image(path(name), image));
    std::filesystem::resize_file(path(name), std::filesystem::file_size(path(name)) / 2);
    const auto cut = read_float_image(path(name));
    ASSERT_FALSE(cut) << name;
    EXPECT_THAT(cut.error().line(), HasSubstr(name));
  }
  const auto text = read_float_image(folder_.write("a.txt", "not a picture"));
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().line(), HasSubstr("neither a PNG nor an EXR"));
  EXPECT_FALSE(read_float_image(path("absent.png")));
}

TEST_F(ImageFiles, AnUnknownEndingIsRefused) {
  const auto refused = write_image(path("a.jpg"), gradient(2, 2));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr(".png or .exr"));
  EXPECT_FALSE(std::filesystem::exists(path("a.jpg")));
}

}  // namespace
}  // namespace halflight
