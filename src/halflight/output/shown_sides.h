// Which sides of the surfaces the lit mesh shows.
#pragma once

#include <cstdint>
#include <vector>

#include "halflight/output/light_reader.h"
#include "halflight/output/weld.h"

namespace halflight {

struct ShownSides {
  bool front = true;
  bool back = false;
};

// A side is shown when light reaches it. Decided together for the connected, consistently wound
// triangles of a primitive instance by reading the light at a few places of both sides; so a wall
// wound away from its room is shown from the room, a curtain from both sides, a box from outside.
// Where nothing is lit the front is shown; emitters always show the side that they emit from.
// A side without any light can only be seen from places without any light.
IdVector<TriangleId, ShownSides> choose_shown_sides(const Scene& scene, const Geometry& geometry,
                                                    const SharedEdges& edges, float feature_size,
                                                    const LightReader& read);

}  // namespace halflight
