// The header of a PNG through libpng's simplified interface, for whoever decodes what follows.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <png.h>

#include "halflight/base/result.h"

namespace halflight {

struct PngReader {
  png_image png{};

  PngReader() { png.version = PNG_IMAGE_VERSION; }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_image_free(&png); }

  // Reads the header. Every chunk must lie in the file: libpng takes as much memory as one claims,
  // up to 2 GB, before it looks for its bytes. `where` names the picture in messages.
  Result<void> begin(std::span<const std::uint8_t> bytes, const std::string& where);
  // What libpng says is wrong.
  tl::unexpected<Error> failure(const std::string& where) const;
};

}  // namespace halflight
