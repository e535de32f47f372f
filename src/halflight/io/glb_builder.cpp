#include "halflight/io/glb_builder.h"

#include <cstring>
#include <limits>

#include "halflight/io/atomic_file.h"

namespace halflight {
namespace {

using nlohmann::json;

// Constants of the glTF 2.0 specification.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963, kNoTarget = 0;
constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

template <class T>
std::span<const std::byte> bytes_of(std::span<const T> values) {
  return std::as_bytes(values);
}

void append_word(std::vector<std::byte>& out, std::uint32_t word) {
  const auto* first = reinterpret_cast<const std::byte*>(&word);
  out.insert(out.end(), first, first + sizeof word);
}

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

int GlbBuilder::append(const char* array, json item) {
  json& items = document[array];
  items.push_back(std::move(item));
  return static_cast<int>(items.size()) - 1;
}

void GlbBuilder::use_extension(const std::string& name, bool required) {
  const auto add_once = [&](const char* list) {
    json& names = document[list];
    for (const auto& known : names)
      if (known == name) return;
    names.push_back(name);
  };
  add_once("extensionsUsed");
  if (required) add_once("extensionsRequired");
}

int GlbBuilder::add_view(std::span<const std::byte> bytes, int target) {
  binary_.resize(padded(binary_.size()));
  json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (target != kNoTarget) view["target"] = target;
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  return append("bufferViews", std::move(view));
}

int GlbBuilder::add_accessor(int view, int component_type, std::size_t count, const char* type) {
  return append(
      "accessors",
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
}

int GlbBuilder::add_vectors(std::span<const Vec3> values) {
  return add_accessor(add_view(bytes_of(values), kArrayBuffer), kFloat, values.size(), "VEC3");
}

int GlbBuilder::add_positions(std::span<const Vec3> values) {
  const int accessor = add_vectors(values);
  Bounds3f bounds;
  for (const Vec3& v : values) bounds.extend(v);
  json& a = document["accessors"][static_cast<std::size_t>(accessor)];
  a["min"] = {bounds.lower.x, bounds.lower.y, bounds.lower.z};
  a["max"] = {bounds.upper.x, bounds.upper.y, bounds.upper.z};
  return accessor;
}

int GlbBuilder::add_uvs(std::span<const Vec2> values) {
  return add_accessor(add_view(bytes_of(values), kArrayBuffer), kFloat, values.size(), "VEC2");
}

int GlbBuilder::add_quaternions(std::span<const Vec4> values) {
  return add_accessor(add_view(bytes_of(values), kNoTarget), kFloat, values.size(), "VEC4");
}

int GlbBuilder::add_triangles(std::span<const std::array<std::uint32_t, 3>> triangles,
                              std::size_t vertex_count) {
  if (vertex_count > std::numeric_limits<std::uint16_t>::max())
    return add_accessor(add_view(std::as_bytes(triangles), kElementArrayBuffer), kUnsignedInt,
                        3 * triangles.size(), "SCALAR");
  std::vector<std::uint16_t> indices;
  indices.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (const std::uint32_t v : t) indices.push_back(static_cast<std::uint16_t>(v));
  return add_accessor(
      add_view(bytes_of(std::span<const std::uint16_t>(indices)), kElementArrayBuffer),
      kUnsignedShort, indices.size(), "SCALAR");
}

int GlbBuilder::add_image(std::span<const std::uint8_t> encoded, const std::string& mime_type,
                          const std::string& name) {
  json image{{"bufferView", add_view(bytes_of(encoded), kNoTarget)}, {"mimeType", mime_type}};
  if (!name.empty()) image["name"] = name;
  return append("images", std::move(image));
}

Result<void> GlbBuilder::finish(const std::filesystem::path& path) {
  document["asset"]["version"] = "2.0";
  document["asset"]["generator"] = "halflight";
  binary_.resize(padded(binary_.size()));
  if (!binary_.empty()) document["buffers"] = {{{"byteLength", binary_.size()}}};

  // Names that are not UTF-8 get replacement characters instead of failing the whole file.
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  text.resize(padded(text.size()), ' ');
  const std::size_t chunks = binary_.empty() ? 1 : 2;
  const std::size_t total = 12 + 8 * chunks + text.size() + binary_.size();
  if (total > std::numeric_limits<std::uint32_t>::max())
    return system_error("the result passes 4 GiB, the limit of GLB", path.string(),
                        "choose a larger feature size");

  std::vector<std::byte> file;
  file.reserve(total);
  append_word(file, kMagic);
  append_word(file, kVersion);
  append_word(file, static_cast<std::uint32_t>(total));
  append_word(file, static_cast<std::uint32_t>(text.size()));
  append_word(file, kJsonChunk);
  const auto json_bytes = std::as_bytes(std::span(text));
  file.insert(file.end(), json_bytes.begin(), json_bytes.end());
  if (!binary_.empty()) {
    append_word(file, static_cast<std::uint32_t>(binary_.size()));
    append_word(file, kBinaryChunk);
    file.insert(file.end(), binary_.begin(), binary_.end());
  }
  return write_file_atomically(path, file);
}

}  // namespace halflight
