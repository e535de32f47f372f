#include "halflight/output/bake_lightmap.h"

#include <algorithm>
#include <array>
#include <utility>

#include "halflight/base/parallel.h"
#include "halflight/output/match_seams.h"

namespace halflight {
namespace {

constexpr std::size_t kBatch = 1 << 15;  // texels between reports
constexpr float kMostTexelsOffCrease = 0.25f;
constexpr float kMostFeaturesOffCrease = 0.125f;

// Readings exactly on a crease are ill-defined: half of their rays may start inside the other wall.
// So points are kept a little off the creases and borders of their face.
Vec3 off_creases(const Geometry& g, TriangleFace f, std::uint8_t borders, const Vec3& p,
                 float distance) {
  if (borders == 0) return p;
  const auto source = g.corners(f.triangle);
  const std::array<Vec3, 3> q{source[source_corner(f.back, 0)], source[source_corner(f.back, 1)],
                              source[source_corner(f.back, 2)]};
  const Vec3 normal = glm::cross(q[1] - q[0], q[2] - q[0]);
  const float square = glm::dot(normal, normal);
  std::array<float, 3> share{}, least{};  // of the corner opposite to side k: 0 on the side
  float sum_of_least = 0.f;
  bool too_near = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = q[(k + 1) % 3] - q[k];
    share[k] = std::max(0.f, glm::dot(glm::cross(edge, p - q[k]), normal) / square);
    const float height = std::sqrt(square) / glm::length(edge);
    if ((borders >> k & 1u) != 0) least[k] = std::min(distance / height, 0.25f);
    sum_of_least += least[k];
    too_near |= share[k] < least[k];
  }
  if (!too_near) return p;
  float above = 0.f;
  for (std::size_t k = 0; k < 3; ++k) above += share[k] = std::max(0.f, share[k] - least[k]);
  Vec3 moved(0.f);
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight =
        least[k] + (1.f - sum_of_least) * (above > 0.f ? share[k] / above : 1.f / 3.f);
    moved += weight * q[(k + 2) % 3];
  }
  return moved;
}

struct TexelSource {
  ReadingPoint point;
  Rgb indirect{0.f};
};

TexelSource source_of(const Geometry& g, const std::vector<LitPrimitive>& primitives,
                      const LightmapCharts& charts, const LightmapLayout& layout,
                      float feature_size, const ChartTexel& texel) {
  const LitPrimitive& p = primitives[texel.primitive];
  const auto& v = p.triangles[texel.triangle];
  const std::array<float, 3> w{1.f - texel.weights.x - texel.weights.y, texel.weights.x,
                               texel.weights.y};
  TexelSource s;
  const TriangleFace face{p.sources[texel.triangle], p.back};
  Vec3 position(0.f), normal(0.f);
  for (std::size_t k = 0; k < 3; ++k) {
    position += w[k] * p.positions[v[k]];
    normal += w[k] * p.normals[v[k]];
    s.indirect += w[k] * p.indirect[v[k]];
  }
  const float length = glm::length(normal);
  const Vec2 density = layout.placed[charts.of(face)].texels_per_metre;
  float off = kMostFeaturesOffCrease * feature_size;
  if (density.x > 0.f) off = std::min(off, kMostTexelsOffCrease / density.x);
  s.point.position =
      off_creases(g, face, charts.borders[face.triangle][face.back ? 1 : 0], position, off);
  s.point.normal = length > 0.f ? normal / length : p.normals[v[0]];
  s.point.triangle = face.triangle;
  s.point.direct_only = true;
  return s;
}

enum class TexelState : std::uint8_t { empty, covered, lit };

// Spreads lit texels over those of a state, ring by ring, within one chart.
void spread(Image& image, std::vector<TexelState>& states, const PlacedChart& at, TexelState over) {
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
           static_cast<std::size_t>(x);
  };
  const auto for_each_neighbour = [&](int x, int y, const auto& visit) {
    for (int ny = std::max(at.y, y - 1); ny < std::min(at.y + at.height, y + 2); ++ny)
      for (int nx = std::max(at.x, x - 1); nx < std::min(at.x + at.width, x + 2); ++nx)
        visit(nx, ny);
  };
  std::vector<std::uint8_t> queued(static_cast<std::size_t>(at.width) * at.height, 0);
  std::vector<std::array<int, 2>> ring, next;
  const auto queue_around = [&](int x, int y) {
    for_each_neighbour(x, y, [&](int nx, int ny) {
      std::uint8_t& mark = queued[static_cast<std::size_t>(ny - at.y) * at.width +
                                  static_cast<std::size_t>(nx - at.x)];
      if (mark != 0 || states[index(nx, ny)] != over) return;
      mark = 1;
      next.push_back({nx, ny});
    });
  };
  for (int y = at.y; y < at.y + at.height; ++y)
    for (int x = at.x; x < at.x + at.width; ++x)
      if (states[index(x, y)] == TexelState::lit) queue_around(x, y);
  while (!next.empty()) {
    ring = std::exchange(next, {});
    for (const auto& [x, y] : ring) {
      Rgb sum(0.f);
      float count = 0.f;
      for_each_neighbour(x, y, [&](int nx, int ny) {
        if (states[index(nx, ny)] != TexelState::lit) return;
        sum += image.pixels[index(nx, ny)];
        count += 1.f;
      });
      image.pixels[index(x, y)] = sum / count;
    }
    for (const auto& [x, y] : ring) states[index(x, y)] = TexelState::lit;
    for (const auto& [x, y] : ring) queue_around(x, y);
  }
}

void spread(Image& image, std::vector<TexelState>& states, const LightmapLayout& layout,
            TexelState over) {
  parallel_for(layout.placed.size(), 16,
               [&](std::size_t i) { spread(image, states, layout.placed[ChartId(i)], over); });
}

// With reflected light about, a place that next to none reaches lies inside of something that is
// not quite closed. Filtering would show its blackness along the outline of what stands there.
constexpr float kBlack = 0.01f;                // of the mean irradiance
constexpr float kLeastReflectedShare = 0.05f;  // of the mean irradiance

// Black texels that touch others get light from those.
void lighten_outlines(Image& image, std::vector<TexelState>& states,
                      const std::vector<ChartTexel>& texels, const LightmapLayout& layout,
                      float mean) {
  const auto is_black = [&](std::size_t i) { return average(image.pixels[i]) < kBlack * mean; };
  std::vector<std::uint32_t> outline;
  for (const ChartTexel& t : texels) {
    if (states[t.index] != TexelState::lit || !is_black(t.index)) continue;
    const int x = static_cast<int>(t.index) % image.width,
              y = static_cast<int>(t.index) / image.width;
    bool beside_light = false;
    for (int ny = std::max(0, y - 1); ny < std::min(image.height, y + 2); ++ny)
      for (int nx = std::max(0, x - 1); nx < std::min(image.width, x + 2); ++nx) {
        const std::size_t n =
            static_cast<std::size_t>(ny) * image.width + static_cast<std::size_t>(nx);
        beside_light |= states[n] == TexelState::lit && !is_black(n);
      }
    if (beside_light) outline.push_back(t.index);
  }
  for (const std::uint32_t i : outline) states[i] = TexelState::covered;
  spread(image, states, layout, TexelState::covered);
}

}  // namespace

Result<Lightmap> bake_lightmap(const Scene& scene, const Geometry& g,
                               std::vector<LitPrimitive>& primitives, const LightmapLight& light,
                               float feature_size, int size, const Progress& progress) {
  Lightmap map;
  map.charts = make_charts(scene, g, primitives, static_cast<double>(size) * size);
  auto layout = pack_charts(map.charts, size);
  if (!layout) return tl::unexpected(layout.error());
  map.layout = std::move(*layout);
  place_in_lightmap(primitives, map.charts, map.layout);
  const std::vector<ChartTexel> texels = find_texels(primitives, map.charts, map.layout);

  map.irradiance = Image(size, size);
  std::vector<TexelState> states(map.irradiance.pixels.size(), TexelState::empty);
  double sum = 0.0, reflected = 0.0;
  for (std::size_t first = 0; first < texels.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, texels.size() - first);
    std::vector<ReadingPoint> points(count);
    std::vector<Rgb> indirect(count);
    parallel_for(count, 256, [&](std::size_t i) {
      const TexelSource s =
          source_of(g, primitives, map.charts, map.layout, feature_size, texels[first + i]);
      points[i] = s.point;
      indirect[i] = s.indirect;
    });
    const std::vector<std::uint8_t> covered = light.covered(points);
    const std::vector<Reading> readings = light.read(points);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t at = texels[first + i].index;
      // A reading taken from a cell of the solution is whole already.
      const bool is_whole = readings[i].indirect != Rgb(0.f);
      map.irradiance.pixels[at] =
          is_whole ? readings[i].irradiance() : readings[i].direct + indirect[i];
      states[at] = covered[i] ? TexelState::covered : TexelState::lit;
      map.covered += covered[i];
      if (covered[i]) continue;
      sum += static_cast<double>(average(map.irradiance.pixels[at]));
      reflected += static_cast<double>(average(indirect[i]));
    }
    progress.report("lightmap",
                    static_cast<double>(first + count) / static_cast<double>(texels.size()));
  }
  map.read = texels.size();
  map.mean_irradiance = static_cast<float>(
      sum / static_cast<double>(std::max<std::size_t>(1, map.read - map.covered)));

  spread(map.irradiance, states, map.layout, TexelState::covered);
  if (reflected > static_cast<double>(kLeastReflectedShare) * sum)
    lighten_outlines(map.irradiance, states, texels, map.layout, map.mean_irradiance);
  // Charts that are covered whole stay as they were read.
  std::replace(states.begin(), states.end(), TexelState::covered, TexelState::lit);
  const float scale = map.mean_irradiance > 0.f ? 1.f / map.mean_irradiance : 0.f;
  map.seam_difference_as_read = scale * seam_difference(map.irradiance, map.charts, map.layout);
  match_seams(map.irradiance, map.charts, map.layout, texels);
  map.seam_difference = scale * seam_difference(map.irradiance, map.charts, map.layout);
  spread(map.irradiance, states, map.layout, TexelState::empty);
  return map;
}

}  // namespace halflight
