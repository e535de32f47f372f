#include <memory>

#include <png.h>

#include "halflight/io/image_reader.h"

namespace halflight {
namespace {

struct FreePng {
  void operator()(png_image* png) const { png_image_free(png); }
};

tl::unexpected<Error> undecodable(const png_image& png, const std::string& where) {
  return input_error(std::string("the PNG picture cannot be decoded: ") + png.message, where,
                     "save it again");
}

// Reads the header.
Result<void> begin(png_image& png, std::span<const std::uint8_t> bytes, const std::string& where) {
  if (auto fits = check_png_chunks(bytes, where); !fits) return fits;
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()))
    return undecodable(png, where);
  return check_image_size({png.width, png.height}, where);
}

}  // namespace

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

Result<ImageSize> png_size(std::span<const std::uint8_t> bytes, const std::string& where) {
  png_image png{};
  const std::unique_ptr<png_image, FreePng> free_on_return(&png);
  return begin(png, bytes, where).map([&] { return ImageSize{png.width, png.height}; });
}

Result<Image8> decode_png(std::span<const std::uint8_t> bytes, const std::string& where) {
  png_image png{};
  const std::unique_ptr<png_image, FreePng> free_on_return(&png);
  if (auto begun = begin(png, bytes, where); !begun) return tl::unexpected(begun.error());
  png.format = PNG_FORMAT_RGBA;
  Image8 image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.texels.resize(std::size_t{png.width} * png.height);
  if (!png_image_finish_read(&png, nullptr, image.texels.data(), 0, nullptr))
    return undecodable(png, where);
  return image;
}

}  // namespace halflight
