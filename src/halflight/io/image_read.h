// Reads PNG and OpenEXR pictures as floats, to measure on them.
#pragma once

#include <filesystem>
#include <string>

#include "halflight/base/image.h"
#include "halflight/base/result.h"
#include "halflight/io/read_file.h"

namespace halflight {

// What the values of a PNG picture become. EXR values are taken as they are.
enum class PngValues {
  linear,     // sRGB undone: proportional to radiance
  as_stored,  // grey level / 255 (16-bit: / 65535)
};

// The format is told by the first bytes. One grey channel fills all three; alpha is put over black.
Result<Image> read_float_image(const std::filesystem::path& path,
                               PngValues png = PngValues::linear);
// `where` names the picture in messages.
Result<Image> decode_float_image(const Bytes& bytes, const std::string& where,
                                 PngValues png = PngValues::linear);

}  // namespace halflight
