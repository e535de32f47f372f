// Places the charts of a lightmap in one square of texels.
#pragma once

#include "halflight/base/result.h"
#include "halflight/output/lightmap_charts.h"

namespace halflight {

inline constexpr int kLeastLightmapSize = 16, kMostLightmapSize = 8192;

// Of charts that are more than a texel wide or high, all round: light of the chart continues there,
// so that neither filtering nor compression mixes charts.
inline constexpr int kLightmapPadding = 2;

struct PlacedChart {
  int x = 0, y = 0;           // first texel, padding included
  int width = 0, height = 0;  // padding included
  int padding = kLightmapPadding;
  bool single = false;         // smaller than a texel: all of it takes its light from one
  Vec2 texels_per_metre{0.f};  // along u and v
};

struct LightmapLayout {
  int size = 0;                  // texels a side
  float texels_per_metre = 0.f;  // where detail is 1
  float filled = 0.f;            // share of the texels that belong to a chart
  IdVector<ChartId, PlacedChart> placed;

  // Texel coordinates: texel i reaches from i to i + 1. The border of a chart's rectangle lies on
  // centres of texels, so light at creases is read there and not extrapolated.
  Vec2 to_texels(const LightmapCharts& charts, ChartId id, const Vec3& p) const;
};

// As many texels per metre as fit, the same for all charts. Charts that are not a texel wide share
// none with others but give up their padding when there are too many. Fails, and tells a size that
// would do, when there are more charts than texels.
Result<LightmapLayout> pack_charts(const LightmapCharts& charts, int size);

}  // namespace halflight
