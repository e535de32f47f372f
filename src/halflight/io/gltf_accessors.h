// Accessors: typed elements inside buffer views, checked before they are read.
#pragma once

#include <cstdint>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/io/gltf_document.h"

namespace halflight {

// glTF's names for its component types.
enum class ComponentType : std::uint32_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126,
};
std::size_t size_of(ComponentType type);

// What an accessor says about itself, checked as far as it goes without the data.
struct AccessorType {
  ComponentType component = ComponentType::float32;
  int components = 1;  // of SCALAR, VEC2, VEC3, VEC4
  bool normalized = false;
  std::size_t count = 0;
  std::size_t element_size() const {
    return size_of(component) * static_cast<std::size_t>(components);
  }
};
AccessorType accessor_type(const JsonCursor& accessor);

// All elements as floats, `components` numbers each: integers are read as they are, or as
// KHR_mesh_quantization says (c / 255, max(c / 127, -1), ...) when the accessor is normalized.
// `index` is the JSON value that names the accessor. Throws ReadFailure.
std::vector<float> read_floats(GltfDocument& document, const JsonCursor& index, int components);
std::vector<Vec2> read_vec2(GltfDocument& document, const JsonCursor& index);
std::vector<Vec3> read_vec3(GltfDocument& document, const JsonCursor& index);

// SCALAR accessors of unsigned integers.
std::vector<std::uint32_t> read_indices(GltfDocument& document, const JsonCursor& index);

}  // namespace halflight
