// Where a picture without a recorded visibility mask seems to be in shadow.
#pragma once

#include "halflight/base/image.h"
#include "halflight/features/binary_image.h"

namespace halflight {

// Pixels darker than 95 % of the lit level around them, which is the grey-level closing of the
// luminance by a square of half the picture's shorter side: the threshold of a black top-hat
// (Serra 1982). An estimate: it takes dark paint for shadow, misses penumbra fainter than 5 %,
// shadows wider than half the picture and bands along its border, and noise breaks it up. Record
// the visibility instead.
BinaryImage estimate_shadow(const Image& image);

}  // namespace halflight
