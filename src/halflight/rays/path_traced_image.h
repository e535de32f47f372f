// Pictures by path tracing, in parallel over pixels.
#pragma once

#include <cstdint>

#include "halflight/base/image.h"
#include "halflight/base/progress.h"
#include "halflight/rays/camera_rays.h"
#include "halflight/rays/path_tracer.h"

namespace halflight {

// Radiance that reaches the camera, box-filtered over each pixel. When cancelled, the rows that
// were not reached stay black.
Image path_traced_image(const PathTracer& tracer, const CameraRays& camera, int width, int height,
                        std::uint32_t samples_per_pixel, std::uint64_t seed,
                        const Progress& progress);

// Share of the direct light that reaches the surface seen at the centre of each pixel, in all three
// channels; 1 where nothing is seen. Shadows are where it is below 1 (the mask of FBEM).
Image visibility_image(const PathTracer& tracer, const CameraRays& camera, int width, int height,
                       std::uint32_t samples_per_pixel, std::uint64_t seed,
                       const Progress& progress);

}  // namespace halflight
