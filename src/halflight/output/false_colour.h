// Scalar fields as colours that the eye orders by value.
#pragma once

#include <span>

#include "halflight/base/image.h"

namespace halflight {

// Viridis (van der Walt and Smith 2015): dark blue at 0, yellow at 1, lightness rising evenly.
// Linear RGB; values outside [0, 1] get the colours of its ends.
Rgb false_colour(float value);

// values[y * width + x] / full_scale as colours; full_scale > 0.
Image false_colour_image(std::span<const float> values, int width, int height, float full_scale);

}  // namespace halflight
