#include "halflight/io/gltf_accessors.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace halflight {
namespace {

// Elements that have been checked to lie inside `bytes`.
struct Elements {
  ByteSpan bytes;
  std::size_t stride = 0;
};

Elements locate(GltfDocument& document, const JsonCursor& holder, std::size_t count,
                std::size_t element_size, bool may_be_strided) {
  const JsonCursor view_index = holder.at("bufferView");
  const ByteSpan view = document.buffer_view(view_index);
  const std::size_t offset = holder.count_or("byteOffset", 0);
  std::size_t stride = may_be_strided ? document.stride(view_index) : 0;
  if (stride == 0) stride = element_size;
  if (stride < element_size) holder.fail("byteStride is smaller than one element");
  const bool fits = offset <= view.size() && element_size <= view.size() - offset &&
                    count - 1 <= (view.size() - offset - element_size) / stride;
  if (count > 0 && !fits) holder.fail("the elements reach beyond their buffer view");
  return {count > 0 ? view.subspan(offset) : ByteSpan(), stride};
}

// Calls body with a value of the C++ type that the component type stands for.
template <class Body>
void with_component(ComponentType type, const Body& body) {
  switch (type) {
    case ComponentType::int8:
      return body(std::int8_t{});
    case ComponentType::uint8:
      return body(std::uint8_t{});
    case ComponentType::int16:
      return body(std::int16_t{});
    case ComponentType::uint16:
      return body(std::uint16_t{});
    case ComponentType::uint32:
      return body(std::uint32_t{});
    case ComponentType::float32:
      return body(float{});
  }
}

template <class T>
float to_float(T component, bool normalized) {
  const float value = static_cast<float>(component);
  if constexpr (std::is_integral_v<T>) {
    if (!normalized) return value;
    return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.f);
  }
  return value;
}

// element_of(i) is the place of the i-th of `count` elements in `out`.
template <class Out, class ElementOf, class Convert>
void copy_elements(const Elements& elements, ComponentType type, std::size_t count, int components,
                   const ElementOf& element_of, const Convert& convert, Out* out) {
  const auto width = static_cast<std::size_t>(components);
  with_component(type, [&](auto tag) {
    using T = decltype(tag);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* from = elements.bytes.data() + i * elements.stride;
      Out* to = out + element_of(i) * width;
      for (std::size_t k = 0; k < width; ++k) {
        T component;
        std::memcpy(&component, from + k * sizeof(T), sizeof(T));
        to[k] = convert(component);
      }
    }
  });
}

void check_unsigned(const JsonCursor& accessor, const AccessorType& type) {
  const bool is_unsigned = type.component == ComponentType::uint8 ||
                           type.component == ComponentType::uint16 ||
                           type.component == ComponentType::uint32;
  if (type.components != 1 || !is_unsigned)
    accessor.fail("indices should be scalar unsigned integers");
}

std::vector<std::uint32_t> read_sparse_indices(GltfDocument& document, const JsonCursor& indices,
                                               std::size_t count, std::size_t limit) {
  const AccessorType type = accessor_type(indices);
  check_unsigned(indices, type);
  const Elements elements = locate(document, indices, count, size_of(type.component), false);
  std::vector<std::uint32_t> targets(count);
  copy_elements(
      elements, type.component, count, 1, [](std::size_t i) { return i; },
      [](auto v) { return static_cast<std::uint32_t>(v); }, targets.data());
  for (const std::uint32_t target : targets)
    if (target >= limit) indices.fail("element " + std::to_string(target) + " does not exist");
  return targets;
}

template <class Out, class Convert>
std::vector<Out> read(GltfDocument& document, const JsonCursor& accessor, const AccessorType& type,
                      const Convert& convert) {
  const auto sparse = accessor.find("sparse");
  const bool has_base = accessor.has("bufferView");
  // Checks the bounds before memory is taken.
  Elements base;
  if (has_base)
    base = locate(document, accessor, type.count, type.element_size(), true);
  else if (type.count > kMaxZeroElements)
    accessor.fail("this many elements without data cannot be held");
  std::vector<Out> out(type.count * static_cast<std::size_t>(type.components));
  if (has_base)
    copy_elements(
        base, type.component, type.count, type.components, [](std::size_t i) { return i; }, convert,
        out.data());
  if (!sparse) return out;
  const std::size_t count = sparse->at("count").count();
  if (count > type.count) sparse->fail("there are more sparse elements than elements");
  const auto targets = read_sparse_indices(document, sparse->at("indices"), count, type.count);
  const Elements values = locate(document, sparse->at("values"), count, type.element_size(), false);
  copy_elements(
      values, type.component, count, type.components,
      [&](std::size_t i) { return std::size_t{targets[i]}; }, convert, out.data());
  return out;
}

template <class Vector>
std::vector<Vector> read_vectors(GltfDocument& document, const JsonCursor& index, int components) {
  const std::vector<float> numbers = read_floats(document, index, components);
  std::vector<Vector> vectors(numbers.size() / static_cast<std::size_t>(components));
  static_assert(sizeof(Vector) % sizeof(float) == 0 && std::is_trivially_copyable_v<Vector>);
  if (!vectors.empty()) std::memcpy(vectors.data(), numbers.data(), numbers.size() * sizeof(float));
  return vectors;
}

}  // namespace

std::size_t size_of(ComponentType type) {
  std::size_t size = 0;
  with_component(type, [&](auto tag) { size = sizeof tag; });
  return size;
}

AccessorType accessor_type(const JsonCursor& accessor) {
  AccessorType type;
  const JsonCursor component = accessor.at("componentType");
  const std::size_t code = component.count();
  if (code < 5120 || code > 5126 || code == 5124)
    component.fail("there is no component type " + std::to_string(code));
  type.component = static_cast<ComponentType>(code);
  const std::string shape = accessor.string_or("type", "SCALAR");
  if (shape.starts_with("VEC") && shape.size() == 4 && shape[3] >= '2' && shape[3] <= '4')
    type.components = shape[3] - '0';
  else if (shape != "SCALAR")
    accessor.fail("elements of type " + shape + " cannot be used here");
  type.normalized = accessor.boolean_or("normalized", false);
  type.count = accessor.count_or("count", 0);
  if (type.count > std::numeric_limits<std::uint32_t>::max())
    accessor.fail("there are too many elements");
  return type;
}

std::vector<float> read_floats(GltfDocument& document, const JsonCursor& index, int components) {
  const JsonCursor accessor = document.element("accessors", index);
  const AccessorType type = accessor_type(accessor);
  if (type.components != components)
    accessor.fail("the elements should have " + std::to_string(components) + " components");
  return read<float>(document, accessor, type,
                     [&](auto component) { return to_float(component, type.normalized); });
}

std::vector<Vec2> read_vec2(GltfDocument& document, const JsonCursor& index) {
  return read_vectors<Vec2>(document, index, 2);
}
std::vector<Vec3> read_vec3(GltfDocument& document, const JsonCursor& index) {
  return read_vectors<Vec3>(document, index, 3);
}

std::vector<std::uint32_t> read_indices(GltfDocument& document, const JsonCursor& index) {
  const JsonCursor accessor = document.element("accessors", index);
  const AccessorType type = accessor_type(accessor);
  check_unsigned(accessor, type);
  return read<std::uint32_t>(document, accessor, type,
                             [](auto v) { return static_cast<std::uint32_t>(v); });
}

}  // namespace halflight
