// JPEG through libjpeg, whose errors jump back: the code between setjmp and the jump holds no
// objects that need destroying.
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>

#include "halflight/io/image_reader.h"

namespace halflight {
namespace {

// Progressive files may hold any number of scans, each a full pass over the picture; encoders write
// ten or so.
constexpr int kMaxScans = 200;
constexpr std::size_t kMaxScannedTexels = std::size_t{1} << 31;

struct Decoder {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf on_error{};
  char message[JMSG_LENGTH_MAX] = "";

  Decoder();
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&jpeg); }

  tl::unexpected<Error> failure(const std::string& where) const {
    return input_error(std::string("the JPEG picture cannot be decoded: ") + message, where,
                       "save it again");
  }
};

void leave(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  (*jpeg->err->format_message)(jpeg, decoder->message);
  std::longjmp(decoder->on_error, 1);
}

void limit_scans(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  const auto scans = static_cast<std::size_t>(decoder->jpeg.input_scan_number);
  const std::size_t texels = std::size_t{decoder->jpeg.image_width} * decoder->jpeg.image_height;
  if (scans <= kMaxScans && scans * texels <= kMaxScannedTexels) return;
  std::strncpy(decoder->message, "too many scans", sizeof decoder->message - 1);
  std::longjmp(decoder->on_error, 1);
}

Decoder::Decoder() {
  jpeg.err = jpeg_std_error(&errors);
  jpeg.client_data = this;
  errors.error_exit = leave;
  errors.output_message = [](j_common_ptr) {};
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

// Reads the header.
Result<ImageSize> begin(Decoder& d, std::span<const std::uint8_t> bytes, const std::string& where) {
  if (!open(d, bytes)) return d.failure(where);
  const ImageSize size{d.jpeg.image_width, d.jpeg.image_height};
  return check_image_size(size, where).map([&] { return size; });
}

}  // namespace

Result<ImageSize> jpeg_size(std::span<const std::uint8_t> bytes, const std::string& where) {
  Decoder d;
  return begin(d, bytes, where);
}

Result<Image8> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& where) {
  Decoder d;
  const Result<ImageSize> size = begin(d, bytes, where);
  if (!size) return tl::unexpected(size.error());
  Image8 image{static_cast<int>(size->width), static_cast<int>(size->height), {}};
  image.texels.resize(size->texels());
  if (!decode(d, image.texels.front().data())) return d.failure(where);
  return image;
}

}  // namespace halflight
