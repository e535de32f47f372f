// A GLB file in the making: a JSON document and the binary chunk that its accessors point into.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "halflight/base/result.h"
#include "halflight/base/vec.h"

namespace halflight {

class GlbBuilder {
 public:
  nlohmann::json document;  // glTF root; `finish` adds buffers, bufferViews, accessors and asset

  // Each returns the index of the new accessor. Positions get the min and max glTF asks for.
  int add_positions(std::span<const Vec3> values);
  int add_vectors(std::span<const Vec3> values);
  int add_uvs(std::span<const Vec2> values);
  int add_quaternions(std::span<const Vec4> values);
  // 16-bit indices where they suffice (65535 itself is the restart value), 32-bit elsewhere.
  int add_triangles(std::span<const std::array<std::uint32_t, 3>> triangles,
                    std::size_t vertex_count);
  // Returns the index of the new image.
  int add_image(std::span<const std::uint8_t> encoded, const std::string& mime_type,
                const std::string& name);

  // Appends to a root array ("nodes", "meshes", ...) and returns the item's index.
  int append(const char* array, nlohmann::json item);
  // Names an extension in extensionsUsed (and extensionsRequired) once.
  void use_extension(const std::string& name, bool required = false);

  // Writes header, JSON and binary chunk. Fails when the file would pass 4 GiB, the format's limit.
  Result<void> finish(const std::filesystem::path& path);

 private:
  int add_view(std::span<const std::byte> bytes, int target);
  int add_accessor(int view, int component_type, std::size_t count, const char* type);
  std::vector<std::byte> binary_;
};

}  // namespace halflight
