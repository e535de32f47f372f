// Meshes of glTF scenes.
#pragma once

#include <map>

#include "halflight/io/gltf_document.h"
#include "halflight/io/gltf_materials.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Reads meshes when nodes ask for them. Points and lines are left out with a warning.
class GltfMeshes {
 public:
  GltfMeshes(GltfDocument& document, GltfMaterials& materials, Scene& scene, ReadWarnings& warnings)
      : document_(document), materials_(materials), scene_(scene), warnings_(warnings) {}

  MeshId read(const JsonCursor& index);

 private:
  std::size_t corner_count(const JsonCursor& json) const;
  void claim(const JsonCursor& json);
  void read_primitive(const JsonCursor& json, Mesh& mesh);
  void read_attributes(const JsonCursor& json, Primitive& primitive);
  void read_corners(const JsonCursor& json, Primitive& primitive);
  void leave_out_broken(const JsonCursor& json, Primitive& primitive);

  GltfDocument& document_;
  GltfMaterials& materials_;
  Scene& scene_;
  ReadWarnings& warnings_;
  ReadBudget vertices_{"vertices", kMaxVertices};
  ReadBudget triangles_{"triangles", kMaxTriangles};
  std::map<std::size_t, MeshId> mesh_of_index_;
};

}  // namespace halflight
