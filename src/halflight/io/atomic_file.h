// Output files appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "halflight/base/result.h"

namespace halflight {

// Writes beside `path`, then renames over it: a reader sees the old bytes or all of the new ones,
// also when the program is killed. Something that is no regular file (a pipe, /dev/stdout) is
// written to as it is.
Result<void> write_file_atomically(const std::filesystem::path& path,
                                   std::span<const std::byte> bytes);

// Tells before any work is done that a file could not be written; an empty path is no file.
Result<void> check_writable(const std::filesystem::path& path);

inline Result<void> write_text_atomically(const std::filesystem::path& path,
                                          std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace halflight
