// The file that a checkpoint is: named arrays, compressed and each with a checksum. It appears
// whole or not at all; what was cut short or changed since is told from what was written.
//
//   magic | version, u32 | sections, u32 | length of the file, u64 | checksum of these, u64
//   for each section:
//     length of its name, u8 | name | size of an item, u32 | length of the array in bytes, u64 |
//     stored length, u64 | checksum of all of these and of what is stored, u64 |
//     for each kChunk bytes of the array: stored length, u32 | for each of them: a zstd frame
//
// Numbers are little-endian. Within a chunk all first bytes of the items come first, then all
// second ones: the exponents of floats beside each other compress well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/io/read_file.h"

namespace halflight {

inline constexpr std::string_view kCheckpointMagic = "\x89HFLT\r\n\x1a";  // no text, no 7-bit file
inline constexpr std::uint32_t kCheckpointVersion = 4;

// Whether a file begins as a checkpoint does, whatever the rest.
bool is_checkpoint(const std::filesystem::path& path);

// The same arrays give the same bytes, for any thread count.
class SectionWriter {
 public:
  template <class T>
  void add(std::string_view name, std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(name, std::as_bytes(items), sizeof(T));
  }
  template <class T>
  void add(std::string_view name, const std::vector<T>& items) {
    add(name, std::span<const T>(items));
  }
  template <class T>
  void add_value(std::string_view name, const T& value) {
    add(name, std::span<const T>(&value, 1));
  }
  void add(std::string_view name, std::string_view text) {
    add(name, std::span(text.data(), text.size()));
  }
  Bytes bytes() const;
  Result<void> write(const std::filesystem::path& path) const;

 private:
  void add_bytes(std::string_view name, std::span<const std::byte> bytes, std::size_t item);

  Bytes body_;
  std::uint32_t sections_ = 0;
};

// Arrays are unpacked when they are asked for.
class SectionReader {
 public:
  // Looks at all of the file but what the arrays hold.
  static Result<SectionReader> open(const std::filesystem::path& path);
  // `where` names the bytes in messages.
  static Result<SectionReader> parse(Bytes bytes, const std::string& where);

  template <class T>
  Result<std::vector<T>> array(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const Section* section = find(name, sizeof(T));
    if (!section) return damaged(name);
    const auto frames = frames_of(*section);
    if (!frames) return tl::unexpected(frames.error());
    std::vector<T> items(section->length / sizeof(T));
    if (auto unpacked = unpack(*section, *frames, std::as_writable_bytes(std::span(items)));
        !unpacked)
      return tl::unexpected(unpacked.error());
    return items;
  }
  Result<std::string> text(std::string_view name) const;

  // "The checkpoint is damaged", and where: for what only those who know the arrays can tell.
  tl::unexpected<Error> damaged(std::string_view section) const;

 private:
  struct Section {
    std::string_view name;
    std::size_t item = 0;
    std::size_t length = 0;                // of the array, bytes
    std::span<const std::uint8_t> stored;  // into bytes_
  };
  // Stored chunks, each of which says that it holds as much as it should.
  using Frames = std::vector<std::span<const std::uint8_t>>;
  Result<Frames> frames_of(const Section& section) const;
  Result<void> unpack(const Section& section, const Frames& frames, std::span<std::byte> to) const;
  const Section* find(std::string_view name, std::size_t item) const;

  std::string where_;
  Bytes bytes_;
  std::vector<Section> sections_;
};

}  // namespace halflight
