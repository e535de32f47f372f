// An office of workplaces in rows: desks in pairs face to face with a divider between, shelves of
// books behind the chairs, windows on one side. The number of small things (books, binders, pens,
// paper) is a parameter; the office grows with it, from four workplaces to an open-plan floor.
// About 60 triangles for each small thing: 20,000 of them make more than a million.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct OfficeParameters {
  int count = 1200;  // small things
  int seed = 1;
};

Knobs knobs(OfficeParameters& p);
Scene office_scene(const OfficeParameters& p = {});

}  // namespace halflight
