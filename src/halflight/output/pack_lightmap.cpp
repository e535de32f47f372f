#include "halflight/output/pack_lightmap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb/stb_rect_pack.h>

namespace halflight {
namespace {

// Charts below a texel take at most this share of the map for their padding.
constexpr double kMostForSingles = 0.125;
constexpr double kStep = 0.9;  // between densities that are tried, downwards
constexpr int kHalvings = 4;   // of the last step: to 0.7 %

PlacedChart measure(const LightmapChart& chart, double density, int size_of_map) {
  const glm::dvec2 size =
      glm::dvec2(chart.size) * density * static_cast<double>(chart.detail);  // texels
  PlacedChart placed;
  placed.single = std::max(size.x, size.y) < 1.0;
  // Stretched by less than a texel, to end on centres; compressed when longer than the map.
  glm::ivec2 steps(0);
  if (!placed.single)
    steps = glm::clamp(glm::ivec2(glm::ceil(size - 1e-3)), 1, size_of_map - 1 - 2 * placed.padding);
  placed.width = steps.x + 1 + 2 * placed.padding;
  placed.height = steps.y + 1 + 2 * placed.padding;
  for (int k = 0; k < 2; ++k)
    placed.texels_per_metre[k] =
        chart.size[k] > 0.f ? static_cast<float>(steps[k]) / chart.size[k] : 0.f;
  return placed;
}

// Texels a side of what a chart below a texel gets, padding included.
int side_of_singles(std::size_t count, int size) {
  for (int padding = kLightmapPadding; padding > 0; --padding) {
    const int side = 1 + 2 * padding;
    if (static_cast<double>(count) * side * side < kMostForSingles * size * size) return side;
  }
  return 1;
}

// Singles in rows at the bottom, all others above. False: there is no room.
bool try_density(const LightmapCharts& charts, double density, LightmapLayout& layout) {
  const int size = layout.size;
  layout.texels_per_metre = static_cast<float>(density);
  layout.placed.clear();
  std::vector<stbrp_rect> rectangles;
  std::size_t singles = 0;
  double used = 0.0;
  for (const LightmapChart& chart : charts.charts) {
    const PlacedChart p = measure(chart, density, size);
    layout.placed.push_back(p);
    singles += p.single;
    if (p.single) continue;
    used += static_cast<double>(p.width) * p.height;
    stbrp_rect r{};
    r.id = static_cast<int>(layout.placed.size() - 1);
    r.w = p.width;
    r.h = p.height;
    rectangles.push_back(r);
  }
  const int side = side_of_singles(singles, size);
  const auto columns = static_cast<std::size_t>(size / side);
  const std::size_t rows = (singles + columns - 1) / columns;
  if (rows * static_cast<std::size_t>(side) > static_cast<std::size_t>(size)) return false;
  const int height = size - static_cast<int>(rows) * side;
  if (used > static_cast<double>(size) * height) return false;

  if (!rectangles.empty()) {
    stbrp_context context{};
    std::vector<stbrp_node> nodes(static_cast<std::size_t>(size));
    stbrp_init_target(&context, size, height, nodes.data(), size);
    if (!stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size())))
      return false;
  }
  for (const stbrp_rect& r : rectangles) {
    PlacedChart& p = layout.placed[ChartId(static_cast<std::size_t>(r.id))];
    p.x = r.x;
    p.y = r.y;
  }
  std::size_t next = 0;
  for (PlacedChart& p : layout.placed) {
    if (!p.single) continue;
    p.padding = side / 2;
    p.width = p.height = side;
    p.x = static_cast<int>(next % columns) * side;
    p.y = height + static_cast<int>(next / columns) * side;
    ++next;
  }
  used += static_cast<double>(singles) * side * side;
  layout.filled = static_cast<float>(used / (static_cast<double>(size) * size));
  return true;
}

}  // namespace

Vec2 LightmapLayout::to_texels(const LightmapCharts& charts, ChartId id, const Vec3& p) const {
  const PlacedChart& at = placed[id];
  const Vec2 corner(static_cast<float>(at.x + at.padding), static_cast<float>(at.y + at.padding));
  return corner + 0.5f + charts.charts[id].to_plane(p) * at.texels_per_metre;
}

Result<LightmapLayout> pack_charts(const LightmapCharts& charts, int size) {
  LightmapLayout layout;
  layout.size = size;
  const std::size_t texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  double area = 0.0, longest = 0.0;
  for (const LightmapChart& chart : charts.charts) {
    const glm::dvec2 extent = glm::dvec2(chart.size) * static_cast<double>(chart.detail);
    area += extent.x * extent.y;
    longest = std::max(longest, extent.x);
  }
  if (charts.charts.size() > texels) {
    const double needed = std::sqrt(1.2 * static_cast<double>(charts.charts.size()));
    return input_error(
        fmt::format("a lightmap of {0} x {0} texels has no room for the {1} charts "
                    "of this scene",
                    size, charts.charts.size()),
        {},
        fmt::format("use at least --lightmap {}", 1 << std::lround(std::ceil(std::log2(needed)))));
  }
  if (!(longest > 0.0)) {
    try_density(charts, 0.0, layout);
    return layout;
  }
  double high = area > 0.0 ? size / std::sqrt(area) : size / longest, low = high * kStep;
  while (!try_density(charts, low, layout)) {
    high = low;
    low = low * longest < 1.0 ? 0.0 : low * kStep;  // 0: nothing but single texels
  }
  if (low == 0.0) return layout;
  for (int k = 0; k < kHalvings; ++k) {
    LightmapLayout finer = layout;
    const double middle = std::sqrt(low * high);
    if (try_density(charts, middle, finer)) {
      layout = std::move(finer);
      low = middle;
    } else {
      high = middle;
    }
  }
  return layout;
}

}  // namespace halflight
