// A closed cubic box in which every surface emits L and reflects rho: then B = pi L / (1 - rho) and
// E = B on every surface, whatever stands in the box.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct FurnaceParameters {
  float radiance = 1.f;      // L of every surface, W/(m2 sr)
  float reflectance = 0.5f;  // rho of every surface
  int boxes = 0;             // cubes that float in the box, of the same material
  float side = 2.f;          // inner side of the box, metres
  int seed = 1;
};

Knobs knobs(FurnaceParameters& p);
Scene furnace_scene(const FurnaceParameters& p = {});

}  // namespace halflight
