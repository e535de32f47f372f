// A view for whoever names none.
#pragma once

#include <cstdint>

#include "halflight/rays/path_tracer.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Tries eyes in the open space before a few hundred surface points, in eight directions each, and
// takes the view that shows most different lit triangles at a comfortable distance. A guess: it
// knows nothing of what matters in the scene. Repeatable.
PlacedCamera automatic_view(const PathTracer& tracer, std::uint64_t seed = 0);

}  // namespace halflight
