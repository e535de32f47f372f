// Writes small glTF scenes for tests: JSON with its data in one embedded or separate buffer.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace halflight {

class GltfBuilder {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};

  GltfBuilder() {
    for (const char* key : {"accessors", "bufferViews", "meshes", "nodes", "materials"})
      json[key] = nlohmann::json::array();
    json["scenes"] = {{{"nodes", nlohmann::json::array()}}};
  }

  // Index of the new element.
  std::size_t add(const char* array, nlohmann::json element) {
    json[array].push_back(std::move(element));
    return json[array].size() - 1;
  }
  template <class T>
  std::size_t add_view(const std::vector<T>& values) {
    const std::size_t offset = data_.size();
    data_.resize(offset + values.size() * sizeof(T));
    std::memcpy(data_.data() + offset, values.data(), values.size() * sizeof(T));
    return add("bufferViews",
               {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}});
  }
  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, int component, const char* type,
                           int components, bool normalized = false) {
    return add("accessors", {{"bufferView", add_view(values)},
                             {"componentType", component},
                             {"type", type},
                             {"count", values.size() / static_cast<std::size_t>(components)},
                             {"normalized", normalized}});
  }
  std::size_t add_positions(const std::vector<float>& xyz) {
    return add_accessor(xyz, 5126, "VEC3", 3);
  }
  std::size_t add_mesh(nlohmann::json primitive) {
    return add("meshes", {{"primitives", {std::move(primitive)}}});
  }
  // A root node of the scene.
  std::size_t add_root(nlohmann::json node) {
    const std::size_t index = add("nodes", std::move(node));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  // A unit right triangle in z = 0, facing +z, under a root node.
  void add_triangle(nlohmann::json material = {}) {
    nlohmann::json primitive = {
        {"attributes", {{"POSITION", add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}};
    if (!material.is_null()) primitive["material"] = add("materials", std::move(material));
    add_root({{"mesh", add_mesh(std::move(primitive))}});
  }

  const std::vector<std::uint8_t>& data() const { return data_; }

  std::string glb() const {
    nlohmann::json all = json;
    if (!all.contains("buffers")) all["buffers"] = {{{"byteLength", data_.size()}}};
    std::string text = all.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    const auto word = [&](std::size_t value) {
      const auto bits = static_cast<std::uint32_t>(value);
      file.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    };
    word(2);
    word(12 + 8 + text.size() + 8 + data_.size());
    word(text.size());
    file += "JSON" + text;
    word(data_.size());
    file += std::string("BIN\0", 4);
    file.append(reinterpret_cast<const char*>(data_.data()), data_.size());
    return file;
  }

 private:
  std::vector<std::uint8_t> data_;
};

}  // namespace halflight
