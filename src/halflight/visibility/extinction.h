// Extinction: how strongly a cluster seen as a medium weakens a ray (paper section 3.1).
#pragma once

#include <span>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/hierarchy/bodies.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// What of its area A a triangle of mean opacity o blocks on average over all directions: o A / 2.
// A ray that crosses a closed body meets it twice, and what the first side has stopped the second
// cannot stop again: there it is o (2 - o) A / 4, for opaque bodies the paper's A / 4. Which bodies
// are closed is decided by their topology (hierarchy/bodies.h).
IdVector<TriangleId, float> blocking_areas(const Scene& scene, const Geometry& geometry,
                                           const Bodies& bodies);

// kappa in 1/m: transmittance over a length l is exp(-kappa l). Exact for small bodies that are
// spread evenly and face all ways.
inline float extinction(float blocking_area, const Bounds3f& box) {
  return blocking_area / box.volume();
}

// Flat boxes get a thickness, so that their volume is not zero.
Bounds3f thickened(const Bounds3f& box);

// kappa for which the mean transmittance over chords of these lengths is the given one. What lets
// through less than 1e-3 counts as that.
float fit_extinction(std::span<const float> chords, float transmittance);

// Mean over the triangle's area.
float mean_opacity(const Scene& scene, const Geometry& geometry, TriangleId triangle);

}  // namespace halflight
