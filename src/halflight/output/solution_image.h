// Pictures of a solution.
#pragma once

#include "halflight/base/image.h"
#include "halflight/base/progress.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/camera_rays.h"

namespace halflight {

// Radiance that reaches the camera, box-filtered over each pixel: direct light read afresh where
// each ray lands, indirect light interpolated over a lit mesh of what these rays meet. Sky and
// emitters are visible.
Image solution_image(const SolverState& state, const LitMeshOptions& mesh, const CameraRays& camera,
                     int width, int height, int samples_per_pixel, const Progress& progress);

}  // namespace halflight
