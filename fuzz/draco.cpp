// Draco's stream alone, inside a GLB that asks for all it may hold.
#include <fmt/format.h>

#include "glb_file.h"
#include "scene_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  fuzz::GlbFile glb;
  glb.binary = fuzz::bytes_of(data, size);
  glb.json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_draco_mesh_compression"],)"
      R"("buffers":[{{"byteLength":{0}}}],"bufferViews":[{{"buffer":0,"byteLength":{0}}}],)"
      R"("accessors":[{{"componentType":5126,"type":"VEC3","count":3}}],"meshes":[{{"primitives":)"
      R"([{{"attributes":{{"POSITION":0}},"extensions":{{"KHR_draco_mesh_compression":)"
      R"({{"bufferView":0,"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}}}}}]}}],)"
      R"("nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]}})",
      size);
  fuzz::inspect(parse_scene(glb.bytes(), "/nowhere/scene.glb"));
  return 0;
}
