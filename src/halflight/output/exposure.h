// How bright to show a lit scene when nobody says.
#pragma once

#include <span>

#include "halflight/io/write_gltf.h"

namespace halflight {

struct ExposureOptions {
  float shown_share = 0.98f;  // this share of the lit area stays below saturation
  float level = 0.9f;         // COLOR_0 at that percentile
};

// Exposure such that `shown_share` of the area that light reaches has COLOR_0 = exposure E / pi up
// to `level`, by the brightest channel. Emitters are left out: they may saturate, and their own
// surface is often brightly lit by what stands near. Unlit area does not count. Radiance is shown
// through a display's own curve, so nothing is tone-mapped here. Deterministic; 1 when nothing is
// lit.
float automatic_exposure(const Scene& scene, const Geometry& geometry,
                         std::span<const LitPrimitive> primitives,
                         const ExposureOptions& options = {});

}  // namespace halflight
