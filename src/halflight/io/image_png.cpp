#include <png.h>

#include "halflight/io/image_reader.h"

namespace halflight {

Result<Image8> decode_png(std::span<const std::uint8_t> bytes, const std::string& where) {
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
