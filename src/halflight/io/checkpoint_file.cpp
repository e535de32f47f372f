#include "halflight/io/checkpoint_file.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>

#include <fmt/format.h>
#include <zstd.h>
#include <zstd_errors.h>

#include "halflight/base/digest.h"
#include "halflight/base/parallel.h"
#include "halflight/io/atomic_file.h"

namespace halflight {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;
constexpr int kLevel = 1;  // higher ones take longer than the disk would for what they save
// Arrays are up to ten times as long as the file of a solve. Nothing but zeros packs to a 3000th.
constexpr std::size_t kMostUnpacked = 256;
constexpr std::size_t kHeader = 8 + 4 + 4 + 8 + 8;

struct FreeCompressor {
  void operator()(ZSTD_CCtx* c) const { ZSTD_freeCCtx(c); }
};
struct FreeDecompressor {
  void operator()(ZSTD_DCtx* d) const { ZSTD_freeDCtx(d); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, FreeCompressor>;
using Decompressor = std::unique_ptr<ZSTD_DCtx, FreeDecompressor>;

// Each takes its memory when it is made or first used.
template <class Context>
Context made(Context context) {
  if (!context) throw std::bad_alloc();
  return context;
}
bool failed(std::size_t result) {
  if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  return ZSTD_isError(result) != 0;
}

template <class T>
void append(Bytes& to, const T& value) {
  const std::size_t at = to.size();
  to.resize(at + sizeof(T));
  std::memcpy(&to[at], &value, sizeof(T));
}
void append(Bytes& to, std::string_view text) { to.insert(to.end(), text.begin(), text.end()); }

// All first bytes of the items, then all second ones; what is no whole item stays at the end.
void sort_bytes(const std::byte* from, std::size_t length, std::size_t item, std::byte* to) {
  const std::size_t n = length / item;
  for (std::size_t k = 0; k < item; ++k)
    for (std::size_t i = 0; i < n; ++i) to[k * n + i] = from[i * item + k];
  std::copy(from + n * item, from + length, to + n * item);
}
void unsort_bytes(const std::byte* from, std::size_t length, std::size_t item, std::byte* to) {
  const std::size_t n = length / item;
  for (std::size_t k = 0; k < item; ++k)
    for (std::size_t i = 0; i < n; ++i) to[i * item + k] = from[k * n + i];
  std::copy(from + n * item, from + length, to + n * item);
}

std::size_t chunks_of(std::size_t length) { return (length + kChunk - 1) / kChunk; }
std::size_t length_of_chunk(std::size_t length, std::size_t chunk) {
  return std::min(kChunk, length - chunk * kChunk);
}

std::uint64_t checksum(std::string_view name, std::uint32_t item, std::uint64_t length,
                       std::span<const std::uint8_t> stored) {
  Digest digest;
  digest.add(name);
  digest.add(item);
  digest.add(length);
  digest.add(stored);
  return digest.value();
}

std::uint64_t header_checksum(std::uint32_t sections, std::uint64_t file_length) {
  Digest digest;
  digest.add(sections);
  digest.add(file_length);
  return digest.value();
}

// Takes numbers off the front of bytes; once these run out all that it says is 0.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  template <class T>
  T number() {
    T value{};
    const auto bytes = take(sizeof(T));
    if (bytes.size() == sizeof(T)) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::span<const std::uint8_t> take(std::uint64_t n) {
    if (n > left_.size()) {
      short_ = true;
      return {};
    }
    const auto bytes = left_.first(n);
    left_ = left_.subspan(n);
    return bytes;
  }
  std::string_view text(std::uint64_t n) {
    const auto bytes = take(n);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  bool ran_short() const { return short_; }
  std::size_t left() const { return left_.size(); }

 private:
  std::span<const std::uint8_t> left_;
  bool short_ = false;
};

constexpr const char* kSolveAnew = "solve the scene again, without --resume";

}  // namespace

bool is_checkpoint(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string begin(kCheckpointMagic.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file && begin == kCheckpointMagic;
}

void SectionWriter::add_bytes(std::string_view name, std::span<const std::byte> bytes,
                              std::size_t item) {
  const std::size_t chunks = chunks_of(bytes.size());
  std::vector<Bytes> frames(chunks);
  parallel_ranges(chunks, 4, [&](std::size_t first, std::size_t last) {
    const Compressor context = made(Compressor(ZSTD_createCCtx()));
    std::vector<std::byte> sorted(kChunk);
    for (std::size_t c = first; c < last; ++c) {
      const auto chunk = bytes.subspan(c * kChunk, std::min(kChunk, bytes.size() - c * kChunk));
      sort_bytes(chunk.data(), chunk.size(), item, sorted.data());
      Bytes& frame = frames[c];
      frame.resize(ZSTD_compressBound(chunk.size()));
      const std::size_t packed = ZSTD_compressCCtx(context.get(), frame.data(), frame.size(),
                                                   sorted.data(), chunk.size(), kLevel);
      if (failed(packed)) throw std::logic_error(ZSTD_getErrorName(packed));
      frame.resize(packed);
    }
  });
  Bytes stored;
  for (const Bytes& frame : frames) append(stored, static_cast<std::uint32_t>(frame.size()));
  for (const Bytes& frame : frames) stored.insert(stored.end(), frame.begin(), frame.end());

  append(body_, static_cast<std::uint8_t>(name.size()));
  append(body_, name);
  append(body_, static_cast<std::uint32_t>(item));
  append(body_, static_cast<std::uint64_t>(bytes.size()));
  append(body_, static_cast<std::uint64_t>(stored.size()));
  append(body_, checksum(name, static_cast<std::uint32_t>(item), bytes.size(), stored));
  body_.insert(body_.end(), stored.begin(), stored.end());
  ++sections_;
}

Bytes SectionWriter::bytes() const {
  Bytes header;
  const std::uint64_t length = kHeader + body_.size();
  append(header, kCheckpointMagic);
  append(header, kCheckpointVersion);
  append(header, sections_);
  append(header, length);
  append(header, header_checksum(sections_, length));
  Bytes file(length);
  std::copy(body_.begin(), body_.end(), std::copy(header.begin(), header.end(), file.begin()));
  return file;
}

Result<void> SectionWriter::write(const std::filesystem::path& path) const {
  const Bytes file = bytes();
  return write_file_atomically(path, std::as_bytes(std::span(file)));
}

Result<SectionReader> SectionReader::open(const std::filesystem::path& path) {
  auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse(std::move(*bytes), path.string());
}

Result<SectionReader> SectionReader::parse(Bytes bytes, const std::string& where) {
  SectionReader reader;
  reader.where_ = where;
  reader.bytes_ = std::move(bytes);

  Cursor cursor(reader.bytes_);
  if (cursor.text(kCheckpointMagic.size()) != kCheckpointMagic)
    return input_error("this is not a checkpoint", reader.where_,
                       "name a file that solve --checkpoint has written");
  const auto version = cursor.number<std::uint32_t>();
  const auto sections = cursor.number<std::uint32_t>();
  const auto length = cursor.number<std::uint64_t>();
  const bool header_holds = cursor.number<std::uint64_t>() == header_checksum(sections, length);
  if (version != kCheckpointVersion && !cursor.ran_short())
    return input_error(fmt::format("the checkpoint is of version {}, and this program reads {}",
                                   version, kCheckpointVersion),
                       reader.where_, "solve the scene again with this program");
  if (cursor.ran_short() || !header_holds) return reader.damaged("header");
  if (length != reader.bytes_.size())
    return input_error(
        fmt::format("the checkpoint was cut short or added to: it has {} bytes instead of {}",
                    reader.bytes_.size(), length),
        reader.where_, kSolveAnew);
  for (std::uint32_t i = 0; i < sections; ++i) {
    Section section;
    section.name = cursor.text(cursor.number<std::uint8_t>());
    const auto item = cursor.number<std::uint32_t>();
    const auto array_length = cursor.number<std::uint64_t>();
    const auto stored_length = cursor.number<std::uint64_t>();
    const auto sum = cursor.number<std::uint64_t>();
    section.stored = cursor.take(stored_length);
    if (cursor.ran_short() || sum != checksum(section.name, item, array_length, section.stored))
      return reader.damaged(fmt::format("section {} of {}", i + 1, sections));
    section.item = item;
    section.length = array_length;
    const std::size_t chunks = section.length / kChunk;  // rounded down: nothing overflows
    if (item == 0 || item > kChunk || array_length % item != 0 ||
        chunks > section.stored.size() / sizeof(std::uint32_t))
      return reader.damaged(section.name);
    reader.sections_.push_back(section);
  }
  if (cursor.left() > 0) return reader.damaged("end");
  std::size_t unpacked = 0;
  for (const Section& section : reader.sections_) unpacked += section.length;
  if (unpacked / kMostUnpacked > length) return reader.damaged("lengths");
  return reader;
}

const SectionReader::Section* SectionReader::find(std::string_view name, std::size_t item) const {
  for (const Section& s : sections_)
    if (s.name == name && s.item == item) return &s;
  return nullptr;
}

Result<SectionReader::Frames> SectionReader::frames_of(const Section& section) const {
  Cursor cursor(section.stored);
  Frames frames(chunks_of(section.length));
  std::vector<std::uint32_t> lengths(frames.size());
  for (std::uint32_t& length : lengths) length = cursor.number<std::uint32_t>();
  for (std::size_t c = 0; c < frames.size(); ++c) {
    frames[c] = cursor.take(lengths[c]);
    if (ZSTD_getFrameContentSize(frames[c].data(), frames[c].size()) !=
        length_of_chunk(section.length, c))
      return damaged(section.name);
  }
  if (cursor.ran_short() || cursor.left() > 0) return damaged(section.name);
  return frames;
}

Result<void> SectionReader::unpack(const Section& section, const Frames& frames,
                                   std::span<std::byte> to) const {
  std::atomic<bool> intact{true};
  parallel_ranges(frames.size(), 4, [&](std::size_t first, std::size_t last) {
    const Decompressor context = made(Decompressor(ZSTD_createDCtx()));
    std::vector<std::byte> sorted(kChunk);
    for (std::size_t c = first; c < last; ++c) {
      const std::size_t length = length_of_chunk(section.length, c);
      const std::size_t unpacked = ZSTD_decompressDCtx(context.get(), sorted.data(), sorted.size(),
                                                       frames[c].data(), frames[c].size());
      if (failed(unpacked) || unpacked != length) {
        intact = false;
        return;
      }
      unsort_bytes(sorted.data(), length, section.item, to.data() + c * kChunk);
    }
  });
  if (!intact) return damaged(section.name);
  return {};
}

Result<std::string> SectionReader::text(std::string_view name) const {
  const auto characters = array<char>(name);
  if (!characters) return tl::unexpected(characters.error());
  return std::string(characters->begin(), characters->end());
}

tl::unexpected<Error> SectionReader::damaged(std::string_view section) const {
  return input_error(fmt::format("the checkpoint is damaged (at its {})", section), where_,
                     kSolveAnew);
}

}  // namespace halflight
