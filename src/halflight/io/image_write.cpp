#include "halflight/io/image_write.h"

#include <array>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <png.h>

#include "halflight/io/atomic_file.h"

namespace halflight {
namespace {

std::uint8_t to_byte(float linear) {
  // A value that is not a number is written as black.
  const float clamped = linear > 0.f ? std::min(linear, 1.f) : 0.f;
  return static_cast<std::uint8_t>(std::lround(255.f * srgb_from_linear(clamped)));
}

Result<void> write_png(const std::filesystem::path& path, const Image& image) {
  std::vector<std::uint8_t> texels;
  texels.reserve(3 * image.pixels.size());
  for (const Rgb& c : image.pixels)
    for (int channel = 0; channel < 3; ++channel) texels.push_back(to_byte(c[channel]));

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, texels.data(), 0, nullptr))
    return system_error(std::string("the PNG encoder failed: ") + png.message, path.string());
  return write_file_atomically(path, std::span(bytes).first(size));
}

// OpenEXR reports failure by exceptions.
Result<void> write_exr(const std::filesystem::path& path, const Image& image) {
  Imf::StdOSStream stream;
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};
    // OpenEXR takes pointers to mutable memory for writing as well, but only reads it.
    auto* base = reinterpret_cast<char*>(const_cast<Rgb*>(image.pixels.data()));
    for (std::size_t channel = 0; channel < kChannels.size(); ++channel) {
      header.channels().insert(kChannels[channel], Imf::Channel(Imf::FLOAT));
      frame.insert(kChannels[channel],
                   Imf::Slice(Imf::FLOAT, base + channel * sizeof(float), sizeof(Rgb),
                              sizeof(Rgb) * static_cast<std::size_t>(image.width)));
    }
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  } catch (const std::exception& e) {
    return system_error(std::string("the EXR encoder failed: ") + e.what(), path.string());
  }
  const std::string bytes = stream.str();
  return write_file_atomically(path, std::as_bytes(std::span(bytes)));
}

}  // namespace

Result<void> check_image_name(const std::filesystem::path& path) {
  if (path.extension() == ".png" || path.extension() == ".exr") return {};
  return input_error("pictures are written as .png or .exr", path.string(), "change the ending");
}

Result<void> write_image(const std::filesystem::path& path, const Image& image) {
  if (auto known = check_image_name(path); !known) return known;
  if (image.pixels.empty()) return input_error("the picture has no pixels", path.string());
  return path.extension() == ".png" ? write_png(path, image) : write_exr(path, image);
}

}  // namespace halflight
