#include "halflight/io/image_read.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStdIO.h>

#include "halflight/io/png_reader.h"
#include "halflight/io/scene_limits.h"

namespace halflight {
namespace {

Result<void> check_size(std::int64_t width, std::int64_t height, const std::string& where) {
  if (width > 0 && height > 0 && width <= kMaxFloatPixels && height <= kMaxFloatPixels / width)
    return {};
  return input_error("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels is too large",
                     where, "at most " + std::to_string(kMaxFloatPixels) + " pixels can be read");
}

// libpng decodes 16-bit files to linear light and 8-bit files to sRGB, as they come.
Result<Image> decode_png_values(const Bytes& bytes, PngValues values, const std::string& where) {
  PngReader reader;
  if (auto begun = reader.begin(bytes, where); !begun) return tl::unexpected(begun.error());
  png_image& png = reader.png;
  if (auto fits = check_size(png.width, png.height, where); !fits)
    return tl::unexpected(fits.error());

  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  const bool deep = (png.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  png.format = deep ? PNG_FORMAT_LINEAR_RGB : PNG_FORMAT_RGB;
  const png_color black{0, 0, 0};
  std::vector<std::uint8_t> texels(deep ? 0 : PNG_IMAGE_SIZE(png));
  std::vector<std::uint16_t> deep_texels(deep ? PNG_IMAGE_SIZE(png) / 2 : 0);
  void* target = deep ? static_cast<void*>(deep_texels.data()) : texels.data();
  if (!png_image_finish_read(&png, &black, target, 0, nullptr)) return reader.failure(where);

  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const float stored = deep ? static_cast<float>(deep_texels[3 * i + k]) / 65535.f
                                : static_cast<float>(texels[3 * i + k]) / 255.f;
      const bool is_linear = deep, want_linear = values == PngValues::linear;
      image.pixels[i][static_cast<int>(k)] = is_linear == want_linear ? stored
                                             : want_linear            ? linear_from_srgb(stored)
                                                                      : srgb_from_linear(stored);
    }
  return image;
}

// OpenEXR takes the memory that an attribute claims before it reads it, so it must lie in the file.
// A header is a row of attributes (name, type, size, so many bytes) that an empty name ends; a file
// of several parts has one for each.
Result<void> check_exr_attributes(const Bytes& bytes, const std::string& where) {
  constexpr std::size_t kFirst = 8;  // behind the magic number and the version
  if (bytes.size() < kFirst) return {};
  const bool several_parts = (bytes[5] & 0x10) != 0;
  auto at = bytes.begin() + kFirst;
  const auto left = [&] { return bytes.end() - at; };
  do {
    while (left() > 0 && *at != 0) {
      for (int text = 0; text < 2; ++text) {
        at = std::find(at, bytes.end(), 0);
        if (left() > 0) ++at;
      }
      std::int32_t size = 0;
      if (left() < std::ptrdiff_t{sizeof size}) return {};  // cut short, which OpenEXR tells
      std::memcpy(&size, &*at, sizeof size);
      at += sizeof size;
      if (size < 0 || size > left())
        return input_error("an attribute of the EXR picture reaches beyond the end of the file",
                           where, "save it again");
      at += size;
    }
    if (left() > 0) ++at;
  } while (several_parts && left() > 0 && *at != 0);
  return {};
}

// R, G, B or one grey channel Y, at full resolution. OpenEXR reports failure by exceptions.
Result<Image> decode_exr(const Bytes& bytes, const std::string& where) {
  if (auto fits = check_exr_attributes(bytes, where); !fits) return tl::unexpected(fits.error());
  try {
    Imf::StdISStream stream;
    stream.str(std::string(bytes.begin(), bytes.end()));
    Imf::InputFile file(stream);
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (auto fits = check_size(width, height, where); !fits) return tl::unexpected(fits.error());

    Image image(static_cast<int>(width), static_cast<int>(height));
    const bool grey = file.header().channels().findChannel("Y") != nullptr &&
                      file.header().channels().findChannel("R") == nullptr;
    const std::array<const char*, 3> names =
        grey ? std::array{"Y", "Y", "Y"} : std::array{"R", "G", "B"};
    Imf::FrameBuffer frame;
    for (std::size_t k = 0; k < (grey ? 1 : names.size()); ++k) {
      const Imf::Channel* channel = file.header().channels().findChannel(names[k]);
      if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
        return input_error(std::string("the EXR picture has no full channel ") + names[k], where,
                           "save it with channels R, G, B or Y");
      // OpenEXR addresses pixels from the window's origin, which may lie outside of our memory.
      frame.insert(names[k],
                   Imf::Slice::Make(
                       Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data()) + k * sizeof(float),
                       window, sizeof(Rgb), sizeof(Rgb) * static_cast<std::size_t>(width)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    if (grey)
      for (Rgb& c : image.pixels) c = Rgb(c.r);
    return image;
  } catch (const std::exception& e) {
    return input_error(std::string("the EXR picture cannot be decoded: ") + e.what(), where,
                       "save it again");
  }
}

bool starts_with(const Bytes& bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

}  // namespace

Result<Image> read_float_image(const std::filesystem::path& path, PngValues png) {
  const Result<Bytes> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_float_image(*bytes, path.string(), png);
}

Result<Image> decode_float_image(const Bytes& bytes, const std::string& where, PngValues png) {
  if (starts_with(bytes, {0x89, 'P', 'N', 'G'})) return decode_png_values(bytes, png, where);
  if (starts_with(bytes, {0x76, 0x2f, 0x31, 0x01})) return decode_exr(bytes, where);
  return input_error("this is neither a PNG nor an EXR picture", where,
                     "convert it to one of them");
}

}  // namespace halflight
