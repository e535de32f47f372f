// Whole files into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/base/result.h"

namespace halflight {

using Bytes = std::vector<std::uint8_t>;

inline std::string_view as_text(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// ".GLB" is ".glb": it tells what a file is.
std::string lower_case_extension(const std::filesystem::path& path);

// Only regular files: a pipe or a device named by a scene file could keep the reader forever.
Result<Bytes> read_file(const std::filesystem::path& path);

}  // namespace halflight
