// Averages over a square of side s around every pixel: the view of someone to whom features smaller
// than s do not matter.
#pragma once

#include "halflight/base/image.h"

namespace halflight {

// Mean over the square [x - s/2, x + s/2]^2, pixels being unit squares: those that it covers in
// part count by their covered share, so the result is continuous in s and s <= 1 changes nothing.
// At the border the square is clipped and the mean taken over what is left.
Image box_filter(const Image& image, double size);

}  // namespace halflight
