// What must hold of every picture that could be read.
#pragma once

#include "fuzz_target.h"
#include "halflight/io/image_read.h"
#include "halflight/io/image_reader.h"

namespace halflight::fuzz {

inline std::size_t texels_of(int width, int height) {
  require(width > 0 && height > 0, "pictures have a size");
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}
inline void look_at(const Result<Image8>& image) {
  if (!image) return require_clear(image.error());
  require(image->texels.size() == texels_of(image->width, image->height), "all texels are there");
}
inline void look_at(const Result<Image>& image) {
  if (!image) return require_clear(image.error());
  require(image->pixels.size() == texels_of(image->width, image->height), "all pixels are there");
}

}  // namespace halflight::fuzz
