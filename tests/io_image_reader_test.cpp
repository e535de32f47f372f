#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstdio>

#include <jpeglib.h>
#include <png.h>
#include <zlib.h>

#include "halflight/io/image_reader.h"

namespace halflight {
namespace {

using Texel = std::array<std::uint8_t, 4>;
using Bytes = std::vector<std::uint8_t>;

Bytes encode_png(int width, int height, const std::vector<Texel>& texels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGBA;
  Bytes bytes(texels.size() * 4 + 1000);
  png_alloc_size_t size = bytes.size();
  EXPECT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, texels.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

Bytes encode_jpeg(int width, int height, const std::vector<std::uint8_t>& rgb) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < height; ++y) {
    Bytes row(rgb.begin() + 3 * width * y, rgb.begin() + 3 * width * (y + 1));
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&jpeg, rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  Bytes bytes(buffer, buffer + size);
  jpeg_destroy_compress(&jpeg);
  std::free(buffer);
  return bytes;
}

TEST(ImageReader, PngTexelsComeBackExactlyTopRowFirst) {
  const std::vector<Texel> texels = {{255, 0, 0, 255}, {0, 255, 0, 128}, {1, 2, 3, 4},
                                     {9, 8, 7, 0},     {0, 0, 0, 255},   {255, 255, 255, 255}};
  const Result<Image8> image = decode_image(encode_png(3, 2, texels), "test.png");
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->texels, texels);
}

TEST(ImageReader, JpegColoursComeBackWithinItsLoss) {
  Bytes rgb;
  for (int i = 0; i < 16 * 16; ++i) rgb.insert(rgb.end(), {200, 100, 50});
  const Result<Image8> image = decode_image(encode_jpeg(16, 16, rgb), "test.jpg");
  ASSERT_TRUE(image) << image.error().line();
  ASSERT_EQ(image->texels.size(), 256u);
  for (const Texel& texel : image->texels) {
    EXPECT_NEAR(texel[0], 200, 2);
    EXPECT_NEAR(texel[1], 100, 2);
    EXPECT_NEAR(texel[2], 50, 2);
    EXPECT_EQ(texel[3], 255);
  }
}

TEST(ImageReader, APictureThatClaimsToBeHugeIsRefusedUnread) {
  Bytes bytes = encode_png(1, 1, {{1, 2, 3, 4}});
  // IHDR: length at 8, name at 12, width at 16, height at 20, checksum over 12..29 at 29.
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  };
  put(16, 60000);
  put(20, 60000);
  put(29, static_cast<std::uint32_t>(crc32(0, bytes.data() + 12, 17)));
  const Result<Image8> image = decode_image(bytes, "bomb.png");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().line(), testing::HasSubstr("bomb.png: the picture has 60000 x 60000"));
}

// libpng would take as much memory as the chunk claims.
TEST(ImageReader, AChunkThatClaimsToBeHugeIsRefusedUnread) {
  Bytes bytes = encode_png(1, 1, {{1, 2, 3, 4}});
  const Bytes chunk{0x45, 0x4e, 0x44, 0x04, 'z', 'T', 'X', 't'};
  bytes.insert(bytes.begin() + 33, chunk.begin(), chunk.end());  // behind the header
  // Also where the file ends right behind the chunk's head, or within what would be its checksum.
  for (const std::size_t length : {bytes.size(), std::size_t{33 + 8 + 3}, std::size_t{33 + 8}}) {
    const Result<Image8> image = decode_image(std::span(bytes).first(length), "bomb.png");
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().line(), testing::HasSubstr("ends inside a chunk"));
  }
}

TEST(ImageReader, CutOffPicturesAreRefusedOrPartlyRead) {
  const Bytes png = encode_png(2, 2, std::vector<Texel>(4, {10, 20, 30, 255}));
  const Bytes jpeg = encode_jpeg(8, 8, Bytes(8 * 8 * 3, 77));
  for (std::size_t length = 0; length < png.size() - 12; ++length)
    EXPECT_FALSE(decode_image(std::span(png).first(length), "cut.png"));
  // JPEG fills in what is missing once it has seen its header.
  for (std::size_t length = 0; length < jpeg.size(); ++length) {
    const Result<Image8> image = decode_image(std::span(jpeg).first(length), "cut.jpg");
    if (image) {
      EXPECT_EQ(image->texels.size(), 64u);
    }
    if (length < 100) {
      EXPECT_FALSE(image);
    }
  }
}

// An uncompressed TGA of 24 bits; `kind` 10 packs runs.
Bytes tga(std::uint8_t kind, std::uint16_t width, std::uint16_t height, std::size_t pixels) {
  Bytes bytes(18);
  bytes[2] = kind;
  bytes[12] = static_cast<std::uint8_t>(width & 255);
  bytes[13] = static_cast<std::uint8_t>(width >> 8);
  bytes[14] = static_cast<std::uint8_t>(height & 255);
  bytes[15] = static_cast<std::uint8_t>(height >> 8);
  bytes[16] = 24;
  for (std::size_t i = 0; i < 3 * pixels; ++i) bytes.push_back(static_cast<std::uint8_t>(i % 251));
  return bytes;
}

// stb_image would show what the memory held before.
TEST(ImageReader, TgaThatEndsEarlyIsRefused) {
  const Bytes whole = tga(2, 20, 30, 600);
  const Result<Image8> image = decode_image(whole, "whole.tga");
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->texels[20 * 29], (Texel{2, 1, 0, 255}));  // bottom row first, blue first
  for (std::size_t length = 18; length < whole.size(); length += 7) {
    const Result<Image8> cut = decode_image(std::span(whole).first(length), "cut.tga");
    ASSERT_FALSE(cut) << length;
    EXPECT_THAT(cut.error().line(), testing::HasSubstr("cut.tga: the picture was cut short"));
  }
  Bytes runs = tga(10, 20, 30, 0);
  for (int i = 0; i < 5; ++i) runs.insert(runs.end(), {0xf7, 1, 2, 3});  // 120 pixels each
  EXPECT_TRUE(decode_image(runs, "runs.tga"));
  runs.pop_back();
  EXPECT_FALSE(decode_image(runs, "runs.tga"));
  EXPECT_FALSE(image_size(tga(2, 16384, 8192, 0), "big.tga"));
}

// Leaves numbers where the next function has its variables.
[[gnu::noinline]] int write_on_stack(unsigned char value) {
  std::array<volatile unsigned char, 1 << 16> numbers;
  for (auto& number : numbers) number = value;
  return numbers[value];
}

// The palette has one colour and the pixels ask for the 200th.
TEST(ImageReader, ColoursThatAPaletteLacksAreTheSameEachTime) {
  Bytes bmp(58);
  const auto put = [&](std::size_t at, std::uint8_t value) { bmp[at] = value; };
  put(0, 'B'), put(1, 'M'), put(10, 58), put(14, 40), put(18, 4), put(22, 1), put(26, 1);
  put(28, 8), put(46, 1), put(54, 9), put(55, 9), put(56, 9);
  bmp.insert(bmp.end(), {0, 200, 201, 255});
  EXPECT_EQ(write_on_stack(17), 17);
  const Result<Image8> image = decode_image(bmp, "test.bmp");
  EXPECT_EQ(write_on_stack(99), 99);
  const Result<Image8> again = decode_image(bmp, "test.bmp");
  ASSERT_TRUE(image && again);
  EXPECT_EQ(image->texels[0], (Texel{9, 9, 9, 255}));
  EXPECT_EQ(image->texels, again->texels);
}

TEST(ImageReader, SizesAreKnownFromHeaders) {
  const auto is = [](const Result<ImageSize>& size, std::size_t width, std::size_t height) {
    return size && size->width == width && size->height == height;
  };
  EXPECT_TRUE(is(image_size(encode_png(3, 2, std::vector<Texel>(6)), "a"), 3, 2));
  EXPECT_TRUE(is(image_size(encode_jpeg(16, 8, Bytes(16 * 8 * 3, 77)), "a"), 16, 8));
  EXPECT_TRUE(is(image_size(tga(2, 5, 7, 35), "a"), 5, 7));
  EXPECT_FALSE(image_size(Bytes(100, 7), "a"));
}

}  // namespace
}  // namespace halflight
