// TGA and BMP pictures.
#include "image_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  fuzz::look_at(decode_tga_or_bmp(std::span(data, size), "picture"));
  return 0;
}
