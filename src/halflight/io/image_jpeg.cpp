// JPEG through libjpeg, whose errors jump back: the code between setjmp and the jump holds no
// objects that need destroying.
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>

#include "halflight/io/image_reader.h"

namespace halflight {
namespace {

// Progressive files may hold any number of scans, each a full pass over the picture.
constexpr int kMaxScans = 200;

struct Decoder {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf on_error{};
  char message[JMSG_LENGTH_MAX] = "";
};

void leave(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  (*jpeg->err->format_message)(jpeg, decoder->message);
  std::longjmp(decoder->on_error, 1);
}

void limit_scans(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  if (decoder->jpeg.input_scan_number <= kMaxScans) return;
  std::strncpy(decoder->message, "too many scans", sizeof decoder->message - 1);
  std::longjmp(decoder->on_error, 1);
}

bool open(Decoder& d, std::span<const std::uint8_t> bytes) {
  if (setjmp(d.on_error)) return false;
  jpeg_create_decompress(&d.jpeg);
  jpeg_mem_src(&d.jpeg, bytes.data(), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&d.jpeg, TRUE);
  d.progress.progress_monitor = limit_scans;
  d.jpeg.progress = &d.progress;
  return true;
}

bool decode(Decoder& d, std::uint8_t* rgba) {
  if (setjmp(d.on_error)) return false;
  d.jpeg.out_color_space = JCS_EXT_RGBA;
  jpeg_start_decompress(&d.jpeg);
  const std::size_t row_bytes = std::size_t{4} * d.jpeg.output_width;
  while (d.jpeg.output_scanline < d.jpeg.output_height) {
    JSAMPROW row = rgba + row_bytes * d.jpeg.output_scanline;
    jpeg_read_scanlines(&d.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&d.jpeg);
  return true;
}

}  // namespace

Result<Image8> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& where) {
  Decoder d;
  d.jpeg.err = jpeg_std_error(&d.errors);
  d.jpeg.client_data = &d;
  d.errors.error_exit = leave;
  d.errors.output_message = [](j_common_ptr) {};
  Image8 image;
  const auto finish = [&](Result<Image8> result) {
    jpeg_destroy_decompress(&d.jpeg);
    return result;
  };
  const auto failure = [&] {
    return finish(input_error(std::string("the JPEG picture cannot be decoded: ") + d.message,
                              where, "save it again"));
  };
  if (!open(d, bytes)) return failure();
  const std::size_t width = d.jpeg.image_width, height = d.jpeg.image_height;
  if (auto fits = check_image_size(width, height, where); !fits)
    return finish(tl::unexpected(fits.error()));
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.texels.resize(width * height);
  if (!decode(d, image.texels.front().data())) return failure();
  return finish(std::move(image));
}

}  // namespace halflight
