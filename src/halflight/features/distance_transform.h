// Distance of every pixel to the nearest clear one: how many erosions it survives.
#pragma once

#include <cstdint>
#include <vector>

#include "halflight/features/binary_image.h"
#include "halflight/features/morphology.h"

namespace halflight {

// Chessboard (eight) or city-block (four) distance in pixels, row by row, 0 at clear pixels; a
// pixel survives n erosions iff its distance is above n. Two raster passes (Rosenfeld and Pfaltz
// 1966): exact for both metrics, time proportional to the pixels. With Outside::ignored an image
// without clear pixels has distance kFarAway everywhere.
std::vector<std::uint32_t> distance_to_clear(const BinaryImage& image, Connectivity connectivity,
                                             Outside outside);

inline constexpr std::uint32_t kFarAway = 1u << 30;

}  // namespace halflight
