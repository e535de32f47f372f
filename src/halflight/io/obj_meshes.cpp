#include "halflight/io/obj_meshes.h"

#include <unordered_map>

namespace halflight {
namespace {

struct CornerHash {
  std::size_t operator()(const ObjCorner& c) const {
    std::uint64_t h = c.position * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 32) ^ c.uv) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 29) ^ c.normal) * 0x94d049bb133111ebull;
    return h ^ (h >> 32);
  }
};

Primitive build_primitive(const ObjMeshes::Triangles& triangles, MaterialId material,
                          const ObjVertexData& data) {
  Primitive p;
  p.material = material;
  std::unordered_map<ObjCorner, std::uint32_t, CornerHash> vertex_of_corner;
  vertex_of_corner.reserve(triangles.size());
  bool any_uv = false, any_normal = false;
  const auto vertex = [&](const ObjCorner& c) {
    const auto next = static_cast<std::uint32_t>(p.positions.size());
    const auto [known, added] = vertex_of_corner.emplace(c, next);
    if (!added) return known->second;
    const bool has_uv = c.uv != ObjCorner::kNone;
    const bool has_normal = c.normal != ObjCorner::kNone && is_finite(data.normals[c.normal]);
    p.positions.push_back(data.positions[c.position]);
    p.uvs[0].push_back(has_uv ? data.uvs[c.uv] : Vec2(0.f));
    p.normals.push_back(has_normal ? data.normals[c.normal] : Vec3(0.f));
    any_uv = any_uv || has_uv;
    any_normal = any_normal || has_normal;
    return next;
  };
  p.triangles.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t first = vertex(a), second = vertex(b), third = vertex(c);
    p.triangles.push_back({first, second, third});
  }
  if (!any_uv) p.uvs[0] = {};
  if (!any_normal) p.normals = {};
  return p;
}

std::string node_name(const std::string& object, const std::string& group,
                      const std::string& fallback) {
  if (object.empty() && group.empty()) return fallback;
  return object.empty() || group.empty() ? object + group : object + "/" + group;
}

}  // namespace

ObjMeshes::Triangles& ObjMeshes::faces(const std::string& object, const std::string& group,
                                       MaterialId material) {
  const auto [named, is_new] =
      group_of_name_.emplace(std::pair(object, group), group_of_name_.size());
  if (is_new) name_bytes_.take(object.size() + group.size(), file_);
  const std::size_t g = named->second;
  const auto [part, added] = part_of_key_.emplace(std::pair(g, material), parts_.size());
  if (added) parts_.push_back({g, material, {}});
  return parts_[part->second].triangles;
}

void ObjMeshes::build(const ObjVertexData& data, const std::string& fallback_name,
                      Scene& scene) const {
  std::vector<std::string> names(group_of_name_.size());
  for (const auto& [name, group] : group_of_name_)
    names[group] = node_name(name.first, name.second, fallback_name);
  std::vector<MeshId> mesh_of_group;
  for (const std::string& name : names) {
    mesh_of_group.push_back(scene.meshes.push_back({name, {}}));
    Node node;
    node.name = name;
    node.mesh = mesh_of_group.back();
    scene.nodes.push_back(std::move(node));
  }
  for (const Part& part : parts_)
    scene.meshes[mesh_of_group[part.group]].primitives.push_back(
        build_primitive(part.triangles, part.material, data));
}

}  // namespace halflight
