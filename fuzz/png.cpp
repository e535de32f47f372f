// PNG, as a texture and as floats to measure on.
#include "image_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  fuzz::look_at(decode_png(std::span(data, size), "picture"));
  const Bytes bytes = fuzz::bytes_of(data, size);
  fuzz::look_at(decode_float_image(bytes, "picture", PngValues::linear));
  fuzz::look_at(decode_float_image(bytes, "picture", PngValues::as_stored));
  return 0;
}
