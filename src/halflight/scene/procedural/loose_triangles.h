// Random clutter: loose two-sided triangles, uniform in place and direction, in a closed room of
// 4 x 3 x 4 m with a ceiling light. Mean free path 2 V / A for V the room's volume and A the summed
// one-sided area: about 4 m with the defaults.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct LooseTrianglesParameters {
  int count = 16384;
  float size = 0.06f;  // side of the (equilateral) triangles, metres
  int seed = 1;
};

Knobs knobs(LooseTrianglesParameters& p);
Scene loose_triangles_scene(const LooseTrianglesParameters& p = {});

}  // namespace halflight
