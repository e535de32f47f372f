// Seams of a lightmap: both charts should show the same light along an edge that they share.
#pragma once

#include "halflight/base/image.h"
#include "halflight/output/lightmap_texels.h"

namespace halflight {

// RMS over all seams of the difference between what bilinear filtering shows on both sides, all
// channels, W/m2.
float seam_difference(const Image& lightmap, const LightmapCharts& charts,
                      const LightmapLayout& layout);

// Moves texels at seams by least squares: towards the same light on both sides, and, with less
// weight, to stay as they are; less yet where their centre lies off the chart.
void match_seams(Image& lightmap, const LightmapCharts& charts, const LightmapLayout& layout,
                 const std::vector<ChartTexel>& texels);

}  // namespace halflight
