#include <png.h>

#include "halflight/io/image_reader.h"

namespace halflight {

Result<void> check_png_chunks(std::span<const std::uint8_t> bytes, const std::string& where) {
  constexpr std::size_t kSignature = 8, kFrame = 12;  // length, kind and checksum of a chunk
  constexpr std::uint32_t kEnd = 0x49454e44;          // "IEND"
  const auto word = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | std::uint32_t{bytes[at + 3]};
  };
  for (std::size_t at = kSignature; at + kFrame <= bytes.size();) {
    const std::size_t length = word(at);
    if (length > bytes.size() - at - kFrame)
      return input_error("the PNG picture cannot be decoded: it ends inside a chunk", where,
                         "save it again");
    if (word(at + 4) == kEnd) break;
    at += kFrame + length;
  }
  return {};
}

Result<Image8> decode_png(std::span<const std::uint8_t> bytes, const std::string& where) {
  if (auto fits = check_png_chunks(bytes, where); !fits) return tl::unexpected(fits.error());
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto failure = [&] {
    const std::string reason = png.message;
    png_image_free(&png);
    return input_error("the PNG picture cannot be decoded: " + reason, where, "save it again");
  };
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return failure();
  if (auto fits = check_image_size(png.width, png.height, where); !fits) {
    png_image_free(&png);
    return tl::unexpected(fits.error());
  }
  png.format = PNG_FORMAT_RGBA;
  Image8 image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.texels.resize(std::size_t{png.width} * png.height);
  if (!png_image_finish_read(&png, nullptr, image.texels.data(), 0, nullptr)) return failure();
  return image;
}

}  // namespace halflight
