// The wall behind one group of cubes, lit by a small light: figures 1 to 4 and table 1.
#pragma once

#include <array>
#include <vector>

#include "halflight/base/image.h"
#include "halflight/features/binary_image.h"

namespace halflight::experiments {

inline constexpr int kGroups = 4;
inline constexpr int kWallPixels = 200;  // along each side, one for each centimetre
inline constexpr std::array kShadowSizes{11.0, 16.5, 22.0, 31.0};  // of the groups, pixels
inline constexpr double kFullLight = 40;  // grey level of the lit middle of the wall; scale is free

// The paper does not say how the group's scene was built or its mesh; see
// scene/procedural/cube_groups.h for the scene that stands for it.
struct CubeWall {
  Image reference;                // grey levels: kFullLight x visibility x cos^4 of the incidence
  std::vector<float> visibility;  // share of the light that each pixel sees
  BinaryImage shadow;             // where it is below 1
};
// group 1 to 4, small to large shadows; exact visibility from every pixel's centre to 8 x 8 places
// on the light.
CubeWall light_cube_wall(int group, int seed);

// The coarse solution: cells of `cell` x `cell` pixels, each with the reference's mean.
Image averaged_over_cells(const Image& reference, int cell);

// Grey levels as a picture whose white is kFullLight.
Image grey_picture(const Image& levels);
// Shadow black on white, as in the paper.
Image mask_picture(const BinaryImage& mask);

double mean_of(const std::vector<float>& values);

}  // namespace halflight::experiments
