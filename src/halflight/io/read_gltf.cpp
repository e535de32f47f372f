#include "halflight/io/read_gltf.h"

#include "halflight/io/gltf_document.h"
#include "halflight/io/gltf_materials.h"
#include "halflight/io/gltf_meshes.h"
#include "halflight/io/gltf_nodes.h"

namespace halflight {

Scene read_gltf(Bytes file, const std::filesystem::path& path) {
  Scene scene;
  ReadWarnings warnings;
  GltfDocument document(std::move(file), path);
  GltfMaterials materials(document, scene, warnings);
  GltfMeshes meshes(document, materials, scene, warnings);
  read_gltf_nodes(document, meshes, scene, warnings);
  materials.decode_textures();
  if (scene.meshes.empty()) warnings.add(path.string() + ": there are no meshes in it");
  scene.warnings = warnings.take();
  return scene;
}

}  // namespace halflight
