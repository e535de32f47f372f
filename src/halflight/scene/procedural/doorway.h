// Two empty rooms side by side, joined by a doorway; a ceiling light hangs in the first only, so
// that the second is lit through the doorway.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct DoorwayParameters {
  float door_width = 0.9f;       // metres
  float door_height = 2.05f;     // metres
  float wall_thickness = 0.15f;  // metres
};

Knobs knobs(DoorwayParameters& p);
Scene doorway_scene(const DoorwayParameters& p = {});

}  // namespace halflight
