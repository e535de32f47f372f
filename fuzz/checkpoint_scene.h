// The scene that the checkpoint target solves: few triangles, one of which gives light.
#pragma once

#include <memory>

#include "halflight/rays/world.h"
#include "halflight/scene/procedural/loose_triangles.h"

namespace halflight::fuzz {

inline std::shared_ptr<const World> checkpoint_world() {
  LooseTrianglesParameters parameters;
  parameters.count = 12;
  return make_world(loose_triangles_scene(parameters));
}

}  // namespace halflight::fuzz
