// Porous clutter: a closed room of 10 x 10 x 3 m with potted plants of thousands of two-sided
// leaves of 1 to 4 cm, and stacks of books between them.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct PlantsParameters {
  int count = 65536;  // triangles in all, kept to within a few percent
  int seed = 1;
};

Knobs knobs(PlantsParameters& p);
Scene plants_scene(const PlantsParameters& p = {});

}  // namespace halflight
