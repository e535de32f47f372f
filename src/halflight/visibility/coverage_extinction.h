// Extinction that keeps what clusters let through on the mean. A / 2V and A / 4V are right for
// small things spread evenly; clusters of clusters have gaps, through which more light passes, and
// flat ones have none.
#pragma once

#include "halflight/visibility/multires_nodes.h"

namespace halflight {

// Each slot gets the extinction for which the mean transmittance over random chords of its box is
// what the triangles inside let through of them, each chord traced exactly. The chords are uniform
// over the lines that meet the box.
void fit_coverage(const Scene& scene, const Geometry& geometry, MultiresNodes& arrays);

}  // namespace halflight
