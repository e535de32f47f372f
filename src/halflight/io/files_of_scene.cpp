#include "halflight/io/files_of_scene.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "halflight/io/data_uri.h"
#include "halflight/io/read_file.h"
#include "halflight/io/text_lines.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kStartOfObj = 1 << 20;  // bytes
// Of hostile files no more are looked at: they are compared by name with every output.
constexpr std::size_t kMostFiles = 1 << 14, kLongestFileName = 4096;  // bytes
constexpr int kMostWords = 32;                                        // options before a map's name

using Files = std::set<fs::path>;

void add(const fs::path& folder, std::string_view name, Files& files) {
  if (!name.empty() && name.size() <= kLongestFileName && files.size() < kMostFiles)
    files.insert(folder / name);
}

Bytes read_part(const fs::path& path, std::size_t first, std::size_t most) {
  std::error_code unknown;
  if (!fs::is_regular_file(path, unknown)) return {};
  const auto size = static_cast<std::size_t>(fs::file_size(path, unknown));
  if (unknown || first >= size) return {};
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(first));
  Bytes bytes(std::min(most, size - first));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return bytes;
}

// The JSON of a glTF: all of it, or the first chunk of a GLB.
Bytes json_of(const fs::path& path) {
  constexpr std::size_t kHeader = 20;  // of the file, and of its first chunk
  const Bytes header = read_part(path, 0, kHeader);
  if (!as_text(header).starts_with("glTF"))
    return lower_case_extension(path) == ".glb" ? Bytes() : read_part(path, 0, SIZE_MAX);
  if (header.size() < kHeader) return {};
  std::uint32_t length = 0;
  std::memcpy(&length, header.data() + 12, sizeof length);
  return read_part(path, kHeader, length);
}

// What follows `"uri":`, wherever it stands. Nothing is parsed: embedded buffers are large.
void add_uris(std::string_view json, const fs::path& folder, Files& files) {
  constexpr std::string_view kKey = "\"uri\"", kSpaces = " \t\r\n";
  for (std::size_t at = json.find(kKey); at != std::string_view::npos; at = json.find(kKey, at)) {
    at += kKey.size();
    const std::size_t colon = json.find_first_not_of(kSpaces, at);
    if (colon == std::string_view::npos || json[colon] != ':') continue;
    const std::size_t first = json.find_first_not_of(kSpaces, colon + 1);
    if (first == std::string_view::npos || json[first] != '"') continue;
    std::size_t last = first + 1;
    while (last < json.size() && json[last] != '"') last += json[last] == '\\' ? 2 : 1;
    if (last >= json.size()) return;
    at = last + 1;
    if (json.substr(first + 1).starts_with("data:")) continue;
    const auto uri = nlohmann::json::parse(json.substr(first, at - first), nullptr, false);
    if (uri.is_string()) add(folder, percent_decoded(uri.get<std::string>()), files);
  }
}

// Names have spaces, and may come after options.
void add_names(std::string_view names, const fs::path& folder, Files& files) {
  add(folder, names, files);
  LineWords words(names);
  for (int i = 0; i < kMostWords && !words.empty(); ++i) {
    add(folder, words.word(), files);
    add(folder, words.rest(), files);
  }
}

// `wanted` are the first words of lines that name files.
void add_named(Bytes text, std::initializer_list<std::string_view> wanted, const fs::path& folder,
               Files& files) {
  TextLines lines(text);
  for (std::string_view line; lines.next(line);) {
    LineWords words(line);
    if (std::count(wanted.begin(), wanted.end(), words.word()) > 0)
      add_names(words.rest(), folder, files);
  }
}

}  // namespace

std::vector<fs::path> files_of_scene(const fs::path& scene) {
  const std::string ending = lower_case_extension(scene);
  const fs::path folder = scene.parent_path();
  Files files;
  if (ending == ".gltf" || ending == ".glb") {
    const Bytes json = json_of(scene);
    add_uris(as_text(json), folder, files);
  }
  if (ending == ".obj") add_named(read_part(scene, 0, kStartOfObj), {"mtllib"}, folder, files);
  const Files libraries = ending == ".obj" ? files : Files();
  for (const fs::path& library : libraries)
    add_named(read_part(library, 0, SIZE_MAX), {"map_Kd", "map_Ke", "map_d"}, library.parent_path(),
              files);
  return {files.begin(), files.end()};
}

}  // namespace halflight
