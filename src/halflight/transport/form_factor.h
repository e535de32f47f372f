// Form factors in closed form.
#pragma once

#include <span>

#include "halflight/base/vec.h"

namespace halflight {

// Form factor from a differential area at x with unit normal n to a convex polygon, unoccluded:
// the share of the irradiance at x that the polygon would give if it had radiosity 1, in [0, 1].
// Lambert's contour integral after clipping to the horizon; counts both sides of the polygon.
// (Lambert 1760; Baum et al. 1989, "Improving radiosity solutions through analytic form factors".)
float polygon_form_factor(const Vec3& x, const Vec3& n, std::span<const Vec3> polygon);

}  // namespace halflight
