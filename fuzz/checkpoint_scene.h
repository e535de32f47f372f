// The scene that the checkpoint target solves: few triangles, one of which gives light.
#pragma once

#include <memory>

#include "halflight/rays/world.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/scene_digest.h"
#include "halflight/solve/checkpoint.h"

namespace halflight::fuzz {

inline std::shared_ptr<const World> checkpoint_world() {
  LooseTrianglesParameters parameters;
  parameters.count = 12;
  return make_world(loose_triangles_scene(parameters));
}

inline SolveOrigin checkpoint_origin(const World& world, LinkMaker links) {
  SolveOrigin origin;
  origin.scene_digest = digest_of(world.scene);
  origin.options.links = links;
  origin.options.feature_size = 2.f;
  origin.options.error = 0.9f;
  origin.options.levels = 1;
  origin.options = resolved(origin.options, world);
  return origin;
}

}  // namespace halflight::fuzz
