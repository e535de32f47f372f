// From the faces of an OBJ file to meshes: corners that share all their indices share a vertex.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "halflight/io/scene_limits.h"
#include "halflight/scene/scene.h"

namespace halflight {

// The v, vt and vn statements read so far. A position that is not finite could not be read.
struct ObjVertexData {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
};

// Indices into ObjVertexData; kNone where a face gives none.
struct ObjCorner {
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::uint32_t position = kNone, uv = kNone, normal = kNone;
  friend bool operator==(const ObjCorner&, const ObjCorner&) = default;
};

// Faces gathered by (object, group) and material, in the order in which each first appears.
class ObjMeshes {
 public:
  using Triangles = std::vector<std::array<ObjCorner, 3>>;

  explicit ObjMeshes(std::string file) : file_(std::move(file)) {}

  // Where further faces of that group and material go.
  Triangles& faces(const std::string& object, const std::string& group, MaterialId material);
  bool empty() const { return parts_.empty(); }

  // Adds a mesh and a node per group, called "object", "group", "object/group" or, when the file
  // names neither, `fallback_name`.
  void build(const ObjVertexData& data, const std::string& fallback_name, Scene& scene) const;

 private:
  struct Part {
    std::size_t group;
    MaterialId material;
    Triangles triangles;
  };
  std::string file_;  // for messages
  using GroupName = std::pair<std::string, std::string>;
  std::map<GroupName, std::size_t> group_of_name_;
  std::map<std::pair<std::size_t, MaterialId>, std::size_t> part_of_key_;
  std::vector<Part> parts_;
  ReadBudget name_bytes_{"bytes of names", kMaxNameBytes};
};

}  // namespace halflight
