// Whole files into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "halflight/base/result.h"

namespace halflight {

using Bytes = std::vector<std::uint8_t>;

// Only regular files: a pipe or a device named by a scene file could keep the reader forever.
Result<Bytes> read_file(const std::filesystem::path& path);

}  // namespace halflight
