// Pictures without perspective of the light on surfaces, so that a feature size is the same number
// of pixels everywhere.
#pragma once

#include <string>
#include <vector>

#include "halflight/base/image.h"
#include "halflight/features/binary_image.h"
#include "halflight/output/light_reader.h"
#include "halflight/rays/path_tracer.h"

namespace halflight::experiments {

// One place for each pixel: the first surface along parallel rays.
struct FlatView {
  std::string name;
  int width = 0, height = 0;
  float pixel = 0.f;                 // metres
  std::vector<ReadingPoint> points;  // row by row; no triangle where nothing was met
};

// Straight down from this share of the scene's height: floor and furniture, below the lamps.
// `pixels` along the longer side.
FlatView view_of_floor(const World& world, float from_height, int pixels);
// From the middle of the scene level towards its end of lowest z: that wall and what stands before
// it.
FlatView view_of_wall(const World& world, int pixels);

// Irradiance at the points, read by `read`.
Image irradiance_picture(const FlatView& view, const LightReader& read);
// The same path-traced.
Image traced_picture(const FlatView& view, const PathTracer& tracer, std::uint32_t samples,
                     std::uint64_t seed);

// Pixels that do not see all of the light.
BinaryImage shadow_in(const FlatView& view, const PathTracer& tracer, std::uint32_t samples);

double mean_of(const Image& picture);

}  // namespace halflight::experiments
