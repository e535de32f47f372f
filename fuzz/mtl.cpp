// MTL text to materials; their pictures are never there.
#include "halflight/io/obj_materials.h"
#include "scene_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  Scene scene;
  ReadWarnings warnings;
  ObjMaterials materials(scene, warnings);
  materials.read_library(fuzz::bytes_of(data, size), "/nowhere/scene.mtl");
  materials.find_or_add("Wall");
  materials.decode_textures();
  fuzz::require_sound(scene);
  return 0;
}
