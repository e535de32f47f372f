#include "halflight/io/encode_png.h"

#include <png.h>

namespace halflight {

std::vector<std::uint8_t> encode_png(int width, int height,
                                     std::span<const std::array<std::uint8_t, 4>> texels) {
  if (width <= 0 || height <= 0 ||
      texels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    return {};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, texels.data(), 0, nullptr))
    return {};
  bytes.resize(size);
  return bytes;
}

}  // namespace halflight
