// Changes bytes of a PNG and makes the checksums of its chunks right again.
#include <cstdint>
#include <cstring>

#include <zlib.h>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

std::uint32_t word_at(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

void mend_checksums(std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kSignature = 8, kFrame = 12;  // length, kind and checksum of a chunk
  for (std::size_t at = kSignature; at + kFrame <= size;) {
    const std::size_t length = word_at(data + at);
    if (length > size - at - kFrame) return;
    const auto sum =
        static_cast<std::uint32_t>(crc32(0, data + at + 4, static_cast<unsigned>(length + 4)));
    for (std::size_t k = 0; k < 4; ++k)
      data[at + 8 + length + k] = static_cast<std::uint8_t>(sum >> (24 - 8 * k));
    at += kFrame + length;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  const std::size_t changed = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 != 0) mend_checksums(data, changed);
  return changed;
}
