// GLB: JSON and a binary chunk, embedded pictures, compressed meshes.
#include "scene_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  fuzz::inspect(parse_scene(fuzz::bytes_of(data, size), "/nowhere/scene.glb"));
  return 0;
}
