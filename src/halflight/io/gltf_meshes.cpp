#include "halflight/io/gltf_meshes.h"

#include <algorithm>
#include <numeric>

#include "halflight/io/gltf_accessors.h"
#include "halflight/io/gltf_draco.h"

namespace halflight {
namespace {

// glTF's "mode" of a primitive.
enum Mode : std::size_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

std::size_t mode_of(const JsonCursor& primitive) {
  const std::size_t mode = primitive.count_or("mode", kTriangles);
  if (mode > kTriangleFan) primitive.at("mode").fail("this is not a primitive mode");
  return mode;
}

std::size_t triangle_count(std::size_t mode, std::size_t corners) {
  if (mode == kTriangles) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// Corners of triangle i. Every second triangle of a strip runs the other way round.
std::array<std::size_t, 3> corners_of(std::size_t mode, std::size_t i) {
  if (mode == kTriangles) return {3 * i, 3 * i + 1, 3 * i + 2};
  if (mode == kTriangleFan) return {0, i + 1, i + 2};
  return i % 2 == 0 ? std::array{i, i + 1, i + 2} : std::array{i, i + 2, i + 1};
}

template <class T>
void check_one_per_vertex(const JsonCursor& accessor, const std::vector<T>& values,
                          const Primitive& primitive) {
  if (values.size() != primitive.positions.size())
    accessor.fail("there are " + std::to_string(values.size()) + " of these for " +
                  std::to_string(primitive.positions.size()) + " vertices");
}

}  // namespace

MeshId GltfMeshes::read(const JsonCursor& index) {
  const JsonCursor json = document_.element("meshes", index);
  const auto [known, added] = mesh_of_index_.try_emplace(index.count());
  if (!added) return known->second;
  Mesh mesh;
  mesh.name = json.name();
  const JsonCursor primitives = json.at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) claim(primitives[i]);
  for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives[i], mesh);
  return known->second = scene_.meshes.push_back(std::move(mesh));
}

std::size_t GltfMeshes::corner_count(const JsonCursor& json) const {
  const auto indices = json.find("indices");
  const JsonCursor accessor = indices ? *indices : json.at("attributes").at("POSITION");
  return accessor_type(document_.element("accessors", accessor)).count;
}

// Takes what the primitive says it holds from the budgets. Draco data speak for themselves later.
void GltfMeshes::claim(const JsonCursor& json) {
  const std::size_t mode = mode_of(json);
  if (mode < kTriangles || json.extension("KHR_draco_mesh_compression")) return;
  const JsonCursor position = json.at("attributes").at("POSITION");
  vertices_.take(accessor_type(document_.element("accessors", position)).count, position.path());
  triangles_.take(triangle_count(mode, corner_count(json)), json.path());
}

void GltfMeshes::read_primitive(const JsonCursor& json, Mesh& mesh) {
  if (mode_of(json) < kTriangles) {
    warnings_.add(json.path() + ": points and lines are ignored");
    return;
  }
  Primitive primitive;
  if (const auto draco = json.extension("KHR_draco_mesh_compression")) {
    read_draco(document_, json, *draco, primitive);
    vertices_.take(primitive.positions.size(), json.path());
    triangles_.take(primitive.triangles.size(), json.path());
  } else {
    read_attributes(json, primitive);
    read_corners(json, primitive);
  }
  if (json.at("attributes").has("COLOR_0"))
    warnings_.add(json.path() + ": vertex colours are ignored; the material's colour counts");
  leave_out_broken(json, primitive);
  const auto material = json.find("material");
  primitive.material = material ? materials_.read(*material) : materials_.default_material();
  mesh.primitives.push_back(std::move(primitive));
}

void GltfMeshes::read_attributes(const JsonCursor& json, Primitive& p) {
  const JsonCursor attributes = json.at("attributes");
  const JsonCursor position = attributes.at("POSITION");
  p.positions = read_vec3(document_, position);
  if (const auto normal = attributes.find("NORMAL")) {
    p.normals = read_vec3(document_, *normal);
    check_one_per_vertex(*normal, p.normals, p);
  }
  for (std::size_t set = 0; set < p.uvs.size(); ++set) {
    const auto uv = attributes.find("TEXCOORD_" + std::to_string(set));
    if (!uv) continue;
    p.uvs[set] = read_vec2(document_, *uv);
    check_one_per_vertex(*uv, p.uvs[set], p);
  }
}

void GltfMeshes::read_corners(const JsonCursor& json, Primitive& p) {
  const std::size_t mode = mode_of(json), corners = corner_count(json);
  const auto indices = json.find("indices");
  std::vector<std::uint32_t> vertex;
  if (indices) {
    vertex = read_indices(document_, *indices);
    const auto largest = std::max_element(vertex.begin(), vertex.end());
    if (largest != vertex.end() && *largest >= p.positions.size())
      indices->fail("an index refers to vertex " + std::to_string(*largest) + " of " +
                    std::to_string(p.positions.size()));
  } else {
    vertex.resize(corners);
    std::iota(vertex.begin(), vertex.end(), 0u);
  }
  p.triangles.resize(triangle_count(mode, corners));
  for (std::size_t i = 0; i < p.triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(mode, i);
    p.triangles[i] = {vertex[a], vertex[b], vertex[c]};
  }
}

// Vertices that are not finite go to the origin, and the triangles that use them go altogether.
void GltfMeshes::leave_out_broken(const JsonCursor& json, Primitive& p) {
  for (Vec3& n : p.normals)
    if (!is_finite(n)) n = Vec3(0.f);
  for (auto& set : p.uvs)
    for (Vec2& uv : set)
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = Vec2(0.f);
  const auto broken = [&](std::uint32_t v) { return !is_finite(p.positions[v]); };
  const std::size_t removed = std::erase_if(p.triangles, [&](const auto& corners) {
    return broken(corners[0]) || broken(corners[1]) || broken(corners[2]);
  });
  for (Vec3& position : p.positions)
    if (!is_finite(position)) position = Vec3(0.f);
  if (removed > 0)
    warnings_.add(json.path() + ": " + std::to_string(removed) +
                  " triangles are left out because their vertices are not finite");
}

}  // namespace halflight
