// A shelf of books before a wall, lit by one panel: a cluster whose contents hide each other. Of
// most books only the spine is seen, their covers stand half a millimetre apart.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct BooksParameters {
  int boards = 3;
  float width = 0.8f;  // of the shelf inside, metres
  int seed = 1;
};

Knobs knobs(BooksParameters& p);
Scene books_scene(const BooksParameters& p = {});

}  // namespace halflight
