#include "halflight/io/image_reader.h"

#include <algorithm>

#include "halflight/io/read_file.h"
#include "halflight/io/scene_limits.h"

namespace halflight {
namespace {

struct Decoder {
  decltype(&decode_png) decode;
  decltype(&png_size) size;
};

Decoder decoder_of(std::span<const std::uint8_t> bytes) {
  switch (image_format(bytes)) {
    case ImageFormat::png:
      return {decode_png, png_size};
    case ImageFormat::jpeg:
      return {decode_jpeg, jpeg_size};
    case ImageFormat::other:
      break;
  }
  return {decode_tga_or_bmp, tga_or_bmp_size};
}

}  // namespace

ImageFormat image_format(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 8> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<std::uint8_t, 3> jpeg{0xff, 0xd8, 0xff};
  const auto starts_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with(png)) return ImageFormat::png;
  if (starts_with(jpeg)) return ImageFormat::jpeg;
  return ImageFormat::other;
}

std::string mime_type(ImageFormat format) {
  switch (format) {
    case ImageFormat::png:
      return "image/png";
    case ImageFormat::jpeg:
      return "image/jpeg";
    case ImageFormat::other:
      break;
  }
  return {};
}

Result<Image8> decode_image(std::span<const std::uint8_t> bytes, const std::string& where) {
  return decoder_of(bytes).decode(bytes, where);
}

Result<ImageSize> image_size(std::span<const std::uint8_t> bytes, const std::string& where) {
  return decoder_of(bytes).size(bytes, where);
}

Result<Image8> read_image(const std::filesystem::path& path) {
  return read_file(path).and_then(
      [&](const Bytes& bytes) { return decode_image(bytes, path.string()); });
}

Result<void> check_image_size(const ImageSize& size, const std::string& where) {
  const auto [width, height] = size;
  if (width == 0 || height == 0) return input_error("the picture is empty", where, "save it again");
  if (width > kMaxTexels || height > kMaxTexels / width)
    return input_error("the picture has " + std::to_string(width) + " x " + std::to_string(height) +
                           " pixels, more than can be read",
                       where, "save it smaller");
  return {};
}

}  // namespace halflight
