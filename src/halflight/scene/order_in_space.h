// Neighbours in space as neighbours in memory.
#pragma once

#include "halflight/scene/scene.h"

namespace halflight {

// Sorts the triangles of large primitives along a space-filling curve, and their vertices by the
// first triangle that uses them. Everything that follows looks up what lies near each other
// together, and files may hold it in any order.
void order_in_space(Scene& scene);

}  // namespace halflight
