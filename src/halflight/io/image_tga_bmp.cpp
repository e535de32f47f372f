// TGA and BMP through stb_image, built here with every other format left out and, by a flag in
// CMakeLists.txt, with all variables set: palettes may have fewer colours than are asked for.
#include <algorithm>
#include <cstring>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include "halflight/io/image_reader.h"

namespace halflight {
namespace {

// Run-length codes of TGA stand for 128 pixels and take two bytes or more.
constexpr std::size_t kMostPixelsPerByte = 64;

// What stb_image reads from. It takes no notice of a file that ends too early: the pixels would be
// whatever the memory held.
struct Source {
  std::span<const std::uint8_t> left;
  const char* buffer = nullptr;  // that stb_image fills ahead, as far as there are bytes
  bool ran_short = false;
};

int read(void* user, char* to, int size) {
  Source& source = *static_cast<Source*>(user);
  const auto wanted = static_cast<std::size_t>(size);
  const std::size_t n = std::min(wanted, source.left.size());
  std::copy_n(source.left.begin(), n, to);
  std::fill(to + n, to + wanted, '\0');
  source.left = source.left.subspan(n);
  if (!source.buffer) source.buffer = to;
  source.ran_short |= n == 0 || (n < wanted && to != source.buffer);
  return static_cast<int>(n);
}
void skip(void* user, int size) {
  Source& source = *static_cast<Source*>(user);
  const auto wanted = static_cast<std::size_t>(std::max(size, 0));
  source.left = source.left.subspan(std::min(wanted, source.left.size()));
}
int at_end(void* user) { return static_cast<Source*>(user)->left.empty() ? 1 : 0; }

constexpr stbi_io_callbacks kCallbacks{read, skip, at_end};

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

tl::unexpected<Error> unreadable(const std::string& where) {
  return input_error("this is not a picture that can be read", where,
                     "save it as PNG, JPEG, TGA or BMP");
}
tl::unexpected<Error> cut_short(const std::string& where) {
  return input_error("the picture was cut short", where, "save it again");
}

}  // namespace

Result<ImageSize> tga_or_bmp_size(std::span<const std::uint8_t> bytes, const std::string& where) {
  Source source{bytes};
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_callbacks(&kCallbacks, &source, &width, &height, &channels) || width < 0 ||
      height < 0)
    return unreadable(where);
  const ImageSize size{static_cast<std::size_t>(width), static_cast<std::size_t>(height)};
  if (auto fits = check_image_size(size, where); !fits) return tl::unexpected(fits.error());
  if (size.texels() / kMostPixelsPerByte > bytes.size()) return cut_short(where);
  return size;
}

Result<Image8> decode_tga_or_bmp(std::span<const std::uint8_t> bytes, const std::string& where) {
  const Result<ImageSize> size = tga_or_bmp_size(bytes, where);
  if (!size) return tl::unexpected(size.error());
  Source source{bytes};
  Image8 image;
  int channels = 0;
  const std::unique_ptr<stbi_uc, FreePixels> pixels(
      stbi_load_from_callbacks(&kCallbacks, &source, &image.width, &image.height, &channels, 4));
  if (!pixels) return unreadable(where);
  if (source.ran_short) return cut_short(where);
  image.texels.resize(size->texels());
  std::memcpy(image.texels.data(), pixels.get(), image.texels.size() * sizeof image.texels[0]);
  return image;
}

}  // namespace halflight
