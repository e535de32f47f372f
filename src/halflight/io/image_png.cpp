#include "halflight/io/image_reader.h"
#include "halflight/io/png_reader.h"

namespace halflight {
namespace {

Result<void> check_chunks(std::span<const std::uint8_t> bytes, const std::string& where) {
  constexpr std::size_t kSignature = 8, kHead = 8, kChecksum = 4;  // a head is length and kind
  constexpr std::uint32_t kEnd = 0x49454e44;                       // "IEND"
  const auto word = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | std::uint32_t{bytes[at + 3]};
  };
  for (std::size_t at = kSignature; at + kHead <= bytes.size();) {
    const std::size_t length = word(at);
    if (length > bytes.size() - at - kHead)
      return input_error("the PNG picture cannot be decoded: it ends inside a chunk", where,
                         "save it again");
    if (word(at + 4) == kEnd) break;
    at += kHead + length + kChecksum;
  }
  return {};
}

Result<void> begin(PngReader& reader, std::span<const std::uint8_t> bytes,
                   const std::string& where) {
  if (auto begun = reader.begin(bytes, where); !begun) return begun;
  return check_image_size({reader.png.width, reader.png.height}, where);
}

}  // namespace

Result<void> PngReader::begin(std::span<const std::uint8_t> bytes, const std::string& where) {
  if (auto fits = check_chunks(bytes, where); !fits) return fits;
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return failure(where);
  return {};
}

tl::unexpected<Error> PngReader::failure(const std::string& where) const {
  return input_error(std::string("the PNG picture cannot be decoded: ") + png.message, where,
                     "save it again");
}

Result<ImageSize> png_size(std::span<const std::uint8_t> bytes, const std::string& where) {
  PngReader reader;
  return begin(reader, bytes, where).map([&] {
    return ImageSize{reader.png.width, reader.png.height};
  });
}

Result<Image8> decode_png(std::span<const std::uint8_t> bytes, const std::string& where) {
  PngReader reader;
  if (auto begun = begin(reader, bytes, where); !begun) return tl::unexpected(begun.error());
  png_image& png = reader.png;
  png.format = PNG_FORMAT_RGBA;
  Image8 image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.texels.resize(std::size_t{png.width} * png.height);
  if (!png_image_finish_read(&png, nullptr, image.texels.data(), 0, nullptr))
    return reader.failure(where);
  return image;
}

}  // namespace halflight
