// Erosion and expansion of binary images (paper section 2.4), n applications at once.
//
// n erosions clear every pixel that has a clear pixel within distance n: chessboard distance for 8
// neighbours (a square of side 2n + 1), city-block distance for 4 (a diamond). Both shapes of
// radius r + t, t <= max(1, r), are unions of shapes of radius r moved by t, so n applications cost
// O(log n) passes of bitwise operations over the words of the image, whatever its size.
#pragma once

#include "halflight/features/binary_image.h"

namespace halflight {

enum class Connectivity { four, eight };  // eight is what the paper's in-place updates amount to

// What erosion takes the pixels beyond the image for.
enum class Outside {
  ignored,  // unknown: the border does not erode (feature masks of a cut-out)
  clear,    // background: the border erodes (objects that are wholly inside the image)
};

BinaryImage erode(const BinaryImage& image, int n, Connectivity connectivity = Connectivity::eight,
                  Outside outside = Outside::ignored);

// Sets every pixel that has a set pixel within distance n; pixels beyond the image set nothing.
BinaryImage expand(const BinaryImage& image, int n,
                   Connectivity connectivity = Connectivity::eight);

// n erosions, then n expansions: only what holds a square (diamond) of radius n survives, that is
// regions wider than 2n pixels.
BinaryImage opening(const BinaryImage& image, int n,
                    Connectivity connectivity = Connectivity::eight,
                    Outside outside = Outside::ignored);

}  // namespace halflight
