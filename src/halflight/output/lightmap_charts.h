// Charts of a lightmap: the shown surfaces cut into connected pieces that are nearly flat, each
// projected onto a plane of its own.
#pragma once

#include <array>
#include <vector>

#include "halflight/io/write_gltf.h"
#include "halflight/output/smooth_sides.h"

namespace halflight {

using ChartId = Id<struct ChartTag>;

struct LightmapChart {
  Vec3 origin{0.f};      // of the plane's (u, v) coordinates: the lower corner of the chart
  Vec3 axis_u{1, 0, 0};  // unit
  Vec3 axis_v{0, 1, 0};  // unit, axis_u x axis_v points to the side that is shown
  Vec2 size{0.f};        // metres; the smallest rectangle around the chart
  float detail = 1.f;    // texels per metre, relative to those of other charts
  std::vector<TriangleFace> faces;  // ascending

  Vec2 to_plane(const Vec3& p) const {
    return {glm::dot(p - origin, axis_u), glm::dot(p - origin, axis_v)};
  }
};

// A place where a surface continues smoothly from one chart into another.
struct ChartSeam {
  std::array<ChartId, 2> charts;
  std::array<Vec3, 2> ends;  // of the edge that they share
};

struct LightmapCharts {
  IdVector<ChartId, LightmapChart> charts;
  IdVector<TriangleId, std::array<ChartId, 2>> of_face;  // front, back; invalid: not shown
  // Side k of a face lies on a crease or on the border of its surface: bit k.
  IdVector<TriangleId, std::array<std::uint8_t, 2>> borders;
  std::vector<ChartSeam> seams;

  ChartId of(TriangleFace f) const { return of_face[f.triangle][f.back ? 1 : 0]; }
};

// Charts grow from the largest faces on over smooth edges, as long as normals stay within 30
// degrees of the first one: nothing is compressed to less than 0.86 of its length. A chart that
// covers a texel twice (a spiral) is cut until none does. `texels` is about how many there will be.
// Surfaces that emit get an eighth of the detail, as their own light drowns what falls on them, and
// charts with hardly any light a quarter.
LightmapCharts make_charts(const Scene& scene, const Geometry& geometry,
                           const std::vector<LitPrimitive>& primitives, double texels);

}  // namespace halflight
