// OBJ text to a scene. Material libraries are never there: mtl.cpp reads them.
#include "scene_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  fuzz::inspect(parse_scene(fuzz::bytes_of(data, size), "/nowhere/scene.obj"));
  return 0;
}
