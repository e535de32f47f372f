// A GLB file as its two chunks.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "halflight/io/read_file.h"

namespace halflight::fuzz {

struct GlbFile {
  std::string json;
  Bytes binary;

  Bytes bytes() const {
    Bytes file;
    const auto word = [&](std::size_t value) {
      for (int k = 0; k < 4; ++k) file.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
    };
    word(0x46546c67);
    word(2);
    word(12 + 8 + json.size() + 8 + binary.size());
    word(json.size());
    word(0x4e4f534a);
    file.insert(file.end(), json.begin(), json.end());
    word(binary.size());
    word(0x004e4942);
    file.insert(file.end(), binary.begin(), binary.end());
    return file;
  }

  static std::optional<GlbFile> parse(const std::uint8_t* data, std::size_t size) {
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      if (at + 4 <= size) std::memcpy(&value, data + at, 4);
      return std::size_t{value};
    };
    if (size < 20 || word(12) > size - 20) return std::nullopt;
    GlbFile glb;
    glb.json.assign(reinterpret_cast<const char*>(data) + 20, word(12));
    const std::size_t chunk = 20 + word(12);
    if (chunk + 8 <= size && word(chunk) <= size - chunk - 8)
      glb.binary.assign(data + chunk + 8, data + chunk + 8 + word(chunk));
    return glb;
  }
};

}  // namespace halflight::fuzz
