// A view for whoever names none.
#pragma once

#include <cstdint>

#include "halflight/rays/path_tracer.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Scatters points over the triangles, each triangle as likely as any other, so that detail counts
// for more than bare walls; tries eyes in the open space before each of them; and takes the view
// that shows most lit points. A guess: it knows nothing of what matters in the scene. Repeatable.
PlacedCamera automatic_view(const PathTracer& tracer, std::uint64_t seed = 0);

}  // namespace halflight
