#include "halflight/output/lightmap_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tsl/robin_map.h>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

// No point of a chart is further from the four texels around it: the diagonal of a texel.
constexpr float kReach = 1.42f;

struct TriangleOfChart {
  std::uint32_t primitive = 0, triangle = 0;
};

std::vector<std::vector<TriangleOfChart>> triangles_by_chart(
    const std::vector<LitPrimitive>& primitives, const LightmapCharts& charts) {
  std::vector<std::vector<TriangleOfChart>> by_chart(charts.charts.size());
  for (std::uint32_t p = 0; p < primitives.size(); ++p)
    for (std::uint32_t t = 0; t < primitives[p].triangles.size(); ++t)
      by_chart[charts.of({primitives[p].sources[t], primitives[p].back}).value].push_back({p, t});
  return by_chart;
}

struct NearestPoint {
  float distance = kInfinity;
  Vec2 weights{0.f};  // of corners 1 and 2
};

// Of a triangle, in the plane.
NearestPoint nearest_point(const std::array<Vec2, 3>& p, Vec2 c) {
  const auto cross = [](Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; };
  const float area = cross(p[1] - p[0], p[2] - p[0]);
  if (area != 0.f) {
    const Vec2 w(cross(c - p[0], p[2] - p[0]) / area, cross(p[1] - p[0], c - p[0]) / area);
    if (w.x >= 0.f && w.y >= 0.f && w.x + w.y <= 1.f) return {0.f, w};
  }
  NearestPoint nearest;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 edge = p[(k + 1) % 3] - p[k];
    const float square = glm::dot(edge, edge);
    const float along =
        square > 0.f ? std::clamp(glm::dot(c - p[k], edge) / square, 0.f, 1.f) : 0.f;
    const float distance = glm::distance(c, p[k] + along * edge);
    if (!(distance < nearest.distance)) continue;
    std::array<float, 3> w{};
    w[k] = 1.f - along;
    w[(k + 1) % 3] = along;
    nearest = {distance, {w[1], w[2]}};
  }
  return nearest;
}

std::vector<ChartTexel> texels_of_chart(const std::vector<LitPrimitive>& primitives,
                                        const std::vector<TriangleOfChart>& triangles,
                                        const PlacedChart& at, int size) {
  // All but the outer padding.
  const int margin = std::max(0, at.padding - 1);
  const int left = at.x + margin, top = at.y + margin;
  const int width = at.width - 2 * margin, height = at.height - 2 * margin;
  std::vector<NearestPoint> nearest(static_cast<std::size_t>(width) * height);
  std::vector<TriangleOfChart> owner(nearest.size());
  for (const TriangleOfChart& t : triangles) {
    const LitPrimitive& p = primitives[t.primitive];
    std::array<Vec2, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = p.lightmap_uvs[p.triangles[t.triangle][k]] * static_cast<float>(size) -
                   Vec2(static_cast<float>(left), static_cast<float>(top)) - 0.5f;
    const Vec2 lower = glm::min(corners[0], glm::min(corners[1], corners[2])) - kReach;
    const Vec2 upper = glm::max(corners[0], glm::max(corners[1], corners[2])) + kReach;
    const int x0 = std::max(0, static_cast<int>(std::ceil(lower.x)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(lower.y)));
    const int x1 = std::min(width - 1, static_cast<int>(std::floor(upper.x)));
    const int y1 = std::min(height - 1, static_cast<int>(std::floor(upper.y)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * width + x;
        if (nearest[i].distance == 0.f) continue;
        const NearestPoint found =
            nearest_point(corners, {static_cast<float>(x), static_cast<float>(y)});
        if (found.distance > kReach || !(found.distance < nearest[i].distance)) continue;
        nearest[i] = found;
        owner[i] = t;
      }
  }
  std::vector<ChartTexel> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (!std::isfinite(nearest[i].distance)) continue;
      const auto index = static_cast<std::uint32_t>((top + y) * size + left + x);
      texels.push_back({index, owner[i].primitive, owner[i].triangle, nearest[i].weights,
                        nearest[i].distance == 0.f});
    }
  return texels;
}

// All of the chart is the one texel: it shows the middle of its largest triangle.
ChartTexel single_texel(const std::vector<LitPrimitive>& primitives,
                        const std::vector<TriangleOfChart>& triangles, const PlacedChart& at,
                        int size) {
  ChartTexel texel;
  texel.index = static_cast<std::uint32_t>((at.y + at.padding) * size + at.x + at.padding);
  texel.weights = Vec2(1.f / 3.f);
  texel.inside = true;
  float largest = -1.f;
  for (const TriangleOfChart& t : triangles) {
    const LitPrimitive& p = primitives[t.primitive];
    const auto& v = p.triangles[t.triangle];
    const Vec3 a = p.positions[v[0]];
    const float area = glm::length(glm::cross(p.positions[v[1]] - a, p.positions[v[2]] - a));
    if (!(area > largest)) continue;
    largest = area;
    texel.primitive = t.primitive;
    texel.triangle = t.triangle;
  }
  return texel;
}

}  // namespace

void place_in_lightmap(std::vector<LitPrimitive>& primitives, const LightmapCharts& charts,
                       const LightmapLayout& layout) {
  parallel_for(primitives.size(), 1, [&](std::size_t i) {
    LitPrimitive& p = primitives[i];
    LitPrimitive placed;
    placed.instance = p.instance;
    placed.back = p.back;
    placed.sources = p.sources;
    tsl::robin_map<std::uint64_t, std::uint32_t> copies;  // by chart and old vertex
    for (std::size_t t = 0; t < p.triangles.size(); ++t) {
      const ChartId chart = charts.of({p.sources[t], p.back});
      auto& triangle = placed.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = p.triangles[t][k];
        const auto next = static_cast<std::uint32_t>(placed.positions.size());
        const auto [entry, is_new] = copies.try_emplace(std::uint64_t{chart.value} << 32 | v, next);
        triangle[k] = entry->second;
        if (!is_new) continue;
        placed.positions.push_back(p.positions[v]);
        placed.normals.push_back(p.normals[v]);
        placed.irradiance.push_back(p.irradiance[v]);
        if (!p.indirect.empty()) placed.indirect.push_back(p.indirect[v]);
        for (std::size_t set = 0; set < 2; ++set)
          if (!p.uvs[set].empty()) placed.uvs[set].push_back(p.uvs[set][v]);
        placed.lightmap_uvs.push_back(layout.to_texels(charts, chart, p.positions[v]) /
                                      static_cast<float>(layout.size));
      }
    }
    p = std::move(placed);
  });
}

std::vector<ChartTexel> find_texels(const std::vector<LitPrimitive>& primitives,
                                    const LightmapCharts& charts, const LightmapLayout& layout) {
  const auto by_chart = triangles_by_chart(primitives, charts);
  return parallel_collect<ChartTexel>(
      by_chart.size(), 1, [&](std::size_t i, std::vector<ChartTexel>& out) {
        const PlacedChart& at = layout.placed[ChartId(i)];
        if (by_chart[i].empty()) return;
        if (at.single) {
          out.push_back(single_texel(primitives, by_chart[i], at, layout.size));
          return;
        }
        const auto texels = texels_of_chart(primitives, by_chart[i], at, layout.size);
        out.insert(out.end(), texels.begin(), texels.end());
      });
}

}  // namespace halflight
