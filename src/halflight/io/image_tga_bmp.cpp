// TGA and BMP through stb_image, built here with every other format left out.
#include <cstring>
#include <limits>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include "halflight/io/image_reader.h"

namespace halflight {

Result<Image8> decode_tga_or_bmp(std::span<const std::uint8_t> bytes, const std::string& where) {
  const auto failure = [&] {
    return input_error("this is not a picture that can be read", where,
                       "save it as PNG, JPEG, TGA or BMP");
  };
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return failure();
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) return failure();
  if (width < 0 || height < 0) return failure();
  if (auto fits = check_image_size(static_cast<std::size_t>(width),
                                   static_cast<std::size_t>(height), where);
      !fits)
    return tl::unexpected(fits.error());
  stbi_uc* pixels = stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4);
  if (!pixels) return failure();
  Image8 image{width, height, {}};
  image.texels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::memcpy(image.texels.data(), pixels, image.texels.size() * 4);
  stbi_image_free(pixels);
  return image;
}

}  // namespace halflight
