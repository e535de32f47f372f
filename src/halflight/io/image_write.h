// Writes pictures: PNG for eyes, OpenEXR for measurements.
#pragma once

#include <filesystem>

#include "halflight/base/image.h"
#include "halflight/base/result.h"

namespace halflight {

// By the ending of the name: .png holds 8-bit sRGB of the values clamped to [0, 1]; .exr holds the
// values themselves as 32-bit floats. The file appears whole or not at all.
Result<void> write_image(const std::filesystem::path& path, const Image& image);

// Nothing when write_image knows the ending of this name: lets a command complain before it works.
Result<void> check_image_name(const std::filesystem::path& path);

}  // namespace halflight
