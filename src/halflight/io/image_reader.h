// Reads PNG, JPEG, TGA and BMP pictures to 8-bit RGBA.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "halflight/base/result.h"

namespace halflight {

struct Image8 {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 4>> texels;  // row 0 on top; sRGB colour, linear alpha
};

struct ImageSize {
  std::size_t width = 0, height = 0;
  std::size_t texels() const { return width * height; }
};

enum class ImageFormat { png, jpeg, other };

// By the first bytes, whatever the file is called.
ImageFormat image_format(std::span<const std::uint8_t> bytes);
// "image/png", "image/jpeg"; empty for other formats.
std::string mime_type(ImageFormat format);

// As the header says, and small enough to be held; of what is no picture, an error. `where` names
// the picture in messages.
Result<ImageSize> image_size(std::span<const std::uint8_t> bytes, const std::string& where);
Result<Image8> decode_image(std::span<const std::uint8_t> bytes, const std::string& where);
Result<Image8> read_image(const std::filesystem::path& path);

// One decoder each; image_size and decode_image choose.
Result<ImageSize> png_size(std::span<const std::uint8_t> bytes, const std::string& where);
Result<ImageSize> jpeg_size(std::span<const std::uint8_t> bytes, const std::string& where);
Result<ImageSize> tga_or_bmp_size(std::span<const std::uint8_t> bytes, const std::string& where);
Result<Image8> decode_png(std::span<const std::uint8_t> bytes, const std::string& where);
Result<Image8> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& where);
Result<Image8> decode_tga_or_bmp(std::span<const std::uint8_t> bytes, const std::string& where);

// Nothing when so many texels can be held.
Result<void> check_image_size(const ImageSize& size, const std::string& where);

}  // namespace halflight
