// Connected regions of a binary image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "halflight/features/binary_image.h"
#include "halflight/features/morphology.h"

namespace halflight {

struct Region {
  int left = 0, top = 0;  // bounding box, in pixels
  int width = 0, height = 0;
  std::size_t pixels = 0;
};

// Regions in the order in which a raster scan meets them; label[y * width + x] is the region's
// index plus one, 0 where the image is clear.
struct Regions {
  std::vector<Region> regions;
  std::vector<std::uint32_t> label;
};

Regions connected_regions(const BinaryImage& image,
                          Connectivity connectivity = Connectivity::eight);

}  // namespace halflight
