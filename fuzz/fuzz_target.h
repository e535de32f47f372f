// What the fuzz targets share: bytes as they come, and what must hold whatever they are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "halflight/base/parallel.h"
#include "halflight/base/result.h"
#include "halflight/io/read_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace halflight::fuzz {

inline void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

// A message that can be read, whatever it repeats of the input.
inline void require_line(const std::string& text) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  require(!text.empty() && text.size() < 2000, "a message is short");
  require(std::none_of(text.begin(), text.end(), is_control), "a message is one line");
}
inline void require_clear(const Error& error) {
  require(!error.what.empty(), "an error says what is wrong");
  require_line(error.line());
}

inline Bytes bytes_of(const std::uint8_t* data, std::size_t size) { return {data, data + size}; }
inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// One thread: what an input does, and so what it covers, is the same each time.
inline const bool kOneThread = (set_thread_count(1), true);

}  // namespace halflight::fuzz
