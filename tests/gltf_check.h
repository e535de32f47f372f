// What the tests of glTF writers share: the Khronos validator and a reader of GLB's JSON chunk.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>
#include <nlohmann/json.hpp>

namespace halflight::test {

inline bool have_gltf_validator() {
  return std::filesystem::exists(std::filesystem::path(HALFLIGHT_GLTF_VALIDATOR) /
                                 "node_modules/gltf-validator") &&
         std::system("node --version >/dev/null 2>&1") == 0;
}

// True when the validator finds no error; its findings go to the test's output.
inline bool is_valid_gltf(const std::filesystem::path& file) {
  const std::string command =
      "node " HALFLIGHT_GLTF_VALIDATOR "/validate.mjs '" + file.string() + "'";
  return std::system(command.c_str()) == 0;
}

// A GLB file taken apart by its specification, independently of the writer.
struct GlbFile {
  nlohmann::json document;
  std::vector<char> binary;

  explicit GlbFile(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    const std::uint32_t json_size = word(bytes, 12);
    document = nlohmann::json::parse(bytes.begin() + 20, bytes.begin() + 20 + json_size);
    if (bytes.size() > 20 + json_size) binary.assign(bytes.begin() + 28 + json_size, bytes.end());
  }

  // Values of a float accessor, components in sequence.
  std::vector<float> floats(std::size_t accessor) const {
    const auto& a = document["accessors"][accessor];
    const auto& view = document["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::string type = a["type"];
    const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
    std::vector<float> values(a["count"].get<std::size_t>() * width);
    std::memcpy(values.data(), binary.data() + view["byteOffset"].get<std::size_t>(),
                values.size() * sizeof(float));
    return values;
  }
  std::vector<std::uint32_t> indices(std::size_t accessor) const {
    const auto& a = document["accessors"][accessor];
    const auto& view = document["bufferViews"][a["bufferView"].get<std::size_t>()];
    const char* first = binary.data() + view["byteOffset"].get<std::size_t>();
    std::vector<std::uint32_t> values(a["count"].get<std::size_t>());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (a["componentType"] == 5123) {
        std::uint16_t v = 0;
        std::memcpy(&v, first + 2 * i, 2);
        values[i] = v;
      } else {
        std::memcpy(&values[i], first + 4 * i, 4);
      }
    }
    return values;
  }

 private:
  static std::uint32_t word(const std::vector<char>& bytes, std::size_t at) {
    std::uint32_t v = 0;
    std::memcpy(&v, bytes.data() + at, sizeof v);
    return v;
  }
};

inline std::filesystem::path temporary_file(const std::string& name) {
  return std::filesystem::temp_directory_path() /
         (std::to_string(::getpid()) + "-halflight-" + name);
}

}  // namespace halflight::test
