// How wide emitters are for the shadows they throw.
#pragma once

#include "halflight/base/ids.h"
#include "halflight/hierarchy/bodies.h"
#include "halflight/rays/world.h"

namespace halflight {

// Of every triangle that emits, metres: the smallest width of all emitting triangles that hang
// together with it, roughly (the middle side of their box). A lamp of many triangles throws the
// shadows of the lamp. 0 for triangles that do not emit.
IdVector<TriangleId, float> emitter_widths(const World& world, const Bodies& bodies);

}  // namespace halflight
