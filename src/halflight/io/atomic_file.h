// Output files appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "halflight/base/result.h"

namespace halflight {

// Writes beside `path`, then renames over it: a reader sees the old bytes or all of the new ones,
// also when the program is killed or others write the same file. A file that was there keeps its
// rights, and a link to one stays a link. What is_written_in_place is written to as it is.
Result<void> write_file_atomically(const std::filesystem::path& path,
                                   std::span<const std::byte> bytes);

// Something that is no regular file and no folder: it may be written to several times. So may the
// standard streams by their names in /dev and /proc, wherever they lead.
bool is_written_in_place(const std::filesystem::path& path);

// Tells before any work is done that a file could not be written; an empty path is no file.
Result<void> check_writable(const std::filesystem::path& path);

inline Result<void> write_text_atomically(const std::filesystem::path& path,
                                          std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace halflight
