// EXT_meshopt_compression: buffer views compressed by meshoptimizer.
#pragma once

#include <cstdint>
#include <span>

#include "halflight/io/json_cursor.h"
#include "halflight/io/read_file.h"
#include "halflight/io/scene_limits.h"

namespace halflight {

// `extension` is the extension object of a buffer view and `data` the bytes it points to. The
// result is count x byteStride bytes, taken from `budget` before they are allocated. Throws
// ReadFailure.
Bytes decode_meshopt(const JsonCursor& extension, std::span<const std::uint8_t> data,
                     ReadBudget& budget);

}  // namespace halflight
