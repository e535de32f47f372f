// Which texels of a lightmap show which places of the lit mesh.
#pragma once

#include <vector>

#include "halflight/output/pack_lightmap.h"

namespace halflight {

// Gives every lit vertex its place in the lightmap, in texels over its size (u to the right, v
// down). Vertices on the border of several charts are doubled.
void place_in_lightmap(std::vector<LitPrimitive>& primitives, const LightmapCharts& charts,
                       const LightmapLayout& layout);

// A texel that bilinear filtering can ask for somewhere on a chart.
struct ChartTexel {
  std::uint32_t index = 0;  // row by row from the top left
  std::uint32_t primitive = 0, triangle = 0;
  Vec2 weights{0.f};    // of the triangle's 2nd and 3rd corner, at the point nearest to its centre
  bool inside = false;  // the centre itself lies on the triangle
};

// By chart, then row by row. The primitives have been placed.
std::vector<ChartTexel> find_texels(const std::vector<LitPrimitive>& primitives,
                                    const LightmapCharts& charts, const LightmapLayout& layout);

}  // namespace halflight
