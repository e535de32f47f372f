// Largest blocked and free width of a binary image (paper sections 3.2 and 4.1).
#pragma once

#include "halflight/features/binary_image.h"
#include "halflight/features/morphology.h"

namespace halflight {

// Side in pixels of the largest square of set pixels inside the image: the number of erosions by a
// 2 x 2 square until nothing is left. Exact for odd and even widths, where 3 x 3 erosions only
// give ceil(side / 2). Regions turned by 45 degrees measure up to sqrt(2) too small.
int largest_square(const BinaryImage& image);

// Widest region that blocks light (set) and widest that lets it through (clear). Pixels beyond the
// image belong to neither: a gap at the border ends there.
int blocked_width(const BinaryImage& image);
int free_width(const BinaryImage& image);

// Number of erosions after which the image is empty, pixels beyond it being clear. A region of
// width w vanishes after ceil(w / 2).
int erosions_until_empty(const BinaryImage& image, Connectivity connectivity);

// Same answer as largest_square by two routes; it picks the faster (up to 128 x 128: erosion).
int largest_square_by_erosion(const BinaryImage& image);  // at most 128 pixels wide
int largest_square_by_distance(const BinaryImage& image);

}  // namespace halflight
