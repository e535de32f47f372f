#include "halflight/output/lightmap_charts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "halflight/base/parallel.h"
#include "halflight/output/disjoint_sets.h"

namespace halflight {
namespace {

constexpr float kCosOfChart = 0.866f;  // 30 degrees
constexpr float kDetailOfEmitters = 0.125f, kDetailInTheDark = 0.25f;
constexpr double kDark = 0.03;           // of the mean irradiance over all charts
constexpr float kOverlapMargin = 0.02f;  // texels: rounding is no overlap

// Faces are numbered 2 t (front) and 2 t + 1 (back).
std::uint32_t number_of(TriangleFace f) { return 2 * f.triangle.value + (f.back ? 1 : 0); }
TriangleFace face_of(std::uint32_t n) { return {TriangleId(n / 2), n % 2 != 0}; }

Vec3 normal_of(const Geometry& g, TriangleFace f) {
  const Vec3 n = glm::normalize(g.scaled_normal(f.triangle));
  return f.back ? -n : n;
}

// Start and end of side k of a face.
std::array<Vec3, 2> side_of_face(const Geometry& g, TriangleFace f, std::size_t k) {
  const auto p = g.corners(f.triangle);
  return {p[source_corner(f.back, k)], p[source_corner(f.back, (k + 1) % 3)]};
}

bool emits(const Scene& scene, const Geometry& g, TriangleFace f) {
  const Material& m = scene.materials[g.materials[f.triangle]];
  return m.emits() && (!f.back || m.double_sided);
}

// The face beyond each side of each face, where the surface continues smoothly.
class FaceNeighbours {
 public:
  FaceNeighbours(const Geometry& g, const SharedEdges& edges,
                 const IdVector<TriangleId, ShownSides>& shown)
      : beyond_(2 * g.triangles.size(), {kNone, kNone, kNone}) {
    for_each_joint(
        edges, shown,
        [&](TriangleFace a, std::uint32_t a_side, TriangleFace b, std::uint32_t b_side) {
          if (!continues(measure_corner(g, a, a_side), measure_corner(g, b, (b_side + 1) % 3)) ||
              !continues(measure_corner(g, a, (a_side + 1) % 3), measure_corner(g, b, b_side)))
            return;
          beyond_[number_of(a)][a_side] = number_of(b);
          beyond_[number_of(b)][b_side] = number_of(a);
        });
  }
  static constexpr std::uint32_t kNone = ~0u;
  const std::array<std::uint32_t, 3>& of(std::uint32_t face) const { return beyond_[face]; }

 private:
  std::vector<std::array<std::uint32_t, 3>> beyond_;
};

using FaceList = std::vector<std::uint32_t>;

// In the order of growing: any first part of a list is connected.
std::vector<FaceList> grow_charts(const Scene& scene, const Geometry& g, const FaceList& faces,
                                  const FaceNeighbours& neighbours) {
  FaceList seeds = faces;
  std::vector<float> areas(2 * g.triangles.size());
  for (const std::uint32_t f : faces) areas[f] = g.area(face_of(f).triangle);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return areas[a] > areas[b]; });
  std::vector<std::uint8_t> taken(2 * g.triangles.size(), 0);
  std::vector<FaceList> charts;
  for (const std::uint32_t seed : seeds) {
    if (taken[seed]) continue;
    const Vec3 axis = normal_of(g, face_of(seed));
    const bool seed_emits = emits(scene, g, face_of(seed));
    FaceList chart{seed};
    taken[seed] = 1;
    for (std::size_t i = 0; i < chart.size(); ++i)
      for (const std::uint32_t next : neighbours.of(chart[i])) {
        if (next == FaceNeighbours::kNone || taken[next]) continue;
        const TriangleFace f = face_of(next);
        if (glm::dot(normal_of(g, f), axis) < kCosOfChart || emits(scene, g, f) != seed_emits)
          continue;
        taken[next] = 1;
        chart.push_back(next);
      }
    charts.push_back(std::move(chart));
  }
  return charts;
}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  const auto turn = [](Vec2 a, Vec2 b, Vec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  std::vector<Vec2> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const Vec2 p : points) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0.f)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Direction of a side of the smallest rectangle around the points: along an edge of their hull.
Vec2 best_direction(const std::vector<Vec2>& points) {
  const std::vector<Vec2> hull = convex_hull(points);
  Vec2 best(1.f, 0.f);
  float least = kInfinity;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const float length = glm::length(edge);
    if (!(length > 0.f)) continue;
    const Vec2 u = edge / length, v(-u.y, u.x);
    Vec2 lower(kInfinity), upper(-kInfinity);
    for (const Vec2 p : hull) {
      const Vec2 q(glm::dot(p, u), glm::dot(p, v));
      lower = glm::min(lower, q), upper = glm::max(upper, q);
    }
    const float area = (upper.x - lower.x) * (upper.y - lower.y);
    // Nearly equal rectangles (of a box) take the first edge whatever the rounding.
    if (area < 0.999f * least) least = area, best = u;
  }
  return best;
}

// Projects the faces along their mean normal into the smallest rectangle, lying on its longer side.
LightmapChart lay_out(const Geometry& g, const FaceList& faces) {
  LightmapChart chart;
  Vec3 normal(0.f);
  for (const std::uint32_t n : faces) {
    const TriangleFace f = face_of(n);
    normal += (f.back ? -1.f : 1.f) * g.scaled_normal(f.triangle);
    chart.faces.push_back(f);
  }
  std::sort(chart.faces.begin(), chart.faces.end(),
            [](TriangleFace a, TriangleFace b) { return number_of(a) < number_of(b); });
  normal = glm::normalize(normal);
  const Vec3 aside = std::abs(normal.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(0, 0, -1);
  chart.axis_u = glm::normalize(glm::cross(aside, normal));
  chart.axis_v = glm::cross(normal, chart.axis_u);
  chart.origin = g.corners(chart.faces.front().triangle)[0];
  std::vector<Vec2> points;
  for (const TriangleFace f : chart.faces)
    for (const Vec3& p : g.corners(f.triangle)) points.push_back(chart.to_plane(p));

  const Vec2 direction = best_direction(points);
  const Vec3 along = direction.x * chart.axis_u + direction.y * chart.axis_v;
  chart.axis_u = glm::normalize(along);
  chart.axis_v = glm::cross(normal, chart.axis_u);
  const auto bounds = [&] {
    std::array<Vec2, 2> b{Vec2(kInfinity), Vec2(-kInfinity)};
    for (const TriangleFace f : chart.faces)
      for (const Vec3& p : g.corners(f.triangle)) {
        b[0] = glm::min(b[0], chart.to_plane(p));
        b[1] = glm::max(b[1], chart.to_plane(p));
      }
    return b;
  };
  auto [lower, upper] = bounds();
  if (upper.y - lower.y > upper.x - lower.x) {
    const Vec3 u = chart.axis_u;
    chart.axis_u = chart.axis_v;
    chart.axis_v = -u;
    const auto turned = bounds();
    lower = turned[0], upper = turned[1];
  }
  chart.origin += lower.x * chart.axis_u + lower.y * chart.axis_v;
  chart.size = upper - lower;
  return chart;
}

// Whether two faces of the chart hold the centre of one square of this side, metres.
bool overlaps(const Geometry& g, const LightmapChart& chart, float square) {
  const int width = static_cast<int>(chart.size.x / square) + 1;
  const int height = static_cast<int>(chart.size.y / square) + 1;
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(width) * height, 0);
  for (const TriangleFace f : chart.faces) {
    std::array<Vec2, 3> p{};
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = chart.to_plane(g.corners(f.triangle)[source_corner(f.back, k)]) / square - 0.5f;
    const Vec2 lower = glm::min(p[0], glm::min(p[1], p[2]));
    const Vec2 upper = glm::max(p[0], glm::max(p[1], p[2]));
    for (int y = std::max(0, static_cast<int>(std::ceil(lower.y)));
         y <= std::min(height - 1, static_cast<int>(std::floor(upper.y))); ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(lower.x)));
           x <= std::min(width - 1, static_cast<int>(std::floor(upper.x))); ++x) {
        bool inside = true;
        for (std::size_t k = 0; k < 3 && inside; ++k) {
          const Vec2 a = p[k], edge = p[(k + 1) % 3] - a;
          const Vec2 c = Vec2(static_cast<float>(x), static_cast<float>(y)) - a;
          inside = edge.x * c.y - edge.y * c.x > kOverlapMargin * glm::length(edge);
        }
        if (!inside) continue;
        std::uint8_t& here = covered[static_cast<std::size_t>(y) * width + x];
        if (here) return true;
        here = 1;
      }
  }
  return false;
}

// The connected parts of a list of faces, each in an order of growing.
std::vector<FaceList> connected_parts(std::span<const std::uint32_t> faces,
                                      const FaceNeighbours& neighbours) {
  FaceList open(faces.begin(), faces.end());
  std::sort(open.begin(), open.end());
  std::vector<std::uint8_t> taken(open.size(), 0);
  std::vector<FaceList> parts;
  for (const std::uint32_t seed : faces) {
    const auto index = [&](std::uint32_t f) {
      const auto at = std::lower_bound(open.begin(), open.end(), f);
      return at != open.end() && *at == f ? static_cast<std::size_t>(at - open.begin())
                                          : open.size();
    };
    if (taken[index(seed)]) continue;
    taken[index(seed)] = 1;
    FaceList part{seed};
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const std::uint32_t next : neighbours.of(part[i])) {
        const std::size_t at = index(next);
        if (at == open.size() || taken[at]) continue;
        taken[at] = 1;
        part.push_back(next);
      }
    parts.push_back(std::move(part));
  }
  return parts;
}

// Halves a chart, in the order in which it grew, until no part covers a square twice.
std::vector<LightmapChart> without_overlaps(const Geometry& g, FaceList faces,
                                            const FaceNeighbours& neighbours, float square) {
  std::vector<LightmapChart> charts;
  std::vector<FaceList> open{std::move(faces)};
  while (!open.empty()) {
    const FaceList list = std::move(open.back());
    open.pop_back();
    LightmapChart chart = lay_out(g, list);
    if (list.size() == 1 || !overlaps(g, chart, square)) {
      charts.push_back(std::move(chart));
      continue;
    }
    const std::span all(list);
    for (const auto half : {all.first(list.size() / 2), all.subspan(list.size() / 2)})
      for (FaceList& part : connected_parts(half, neighbours)) open.push_back(std::move(part));
  }
  return charts;
}

IdVector<TriangleId, ShownSides> shown_in(const Geometry& g,
                                          const std::vector<LitPrimitive>& primitives) {
  IdVector<TriangleId, ShownSides> shown(g.triangles.size(), {false, false});
  for (const LitPrimitive& p : primitives)
    for (const TriangleId t : p.sources) (p.back ? shown[t].back : shown[t].front) = true;
  return shown;
}

// Chooses by what is there to be seen.
void choose_detail(const Scene& scene, const Geometry& g,
                   const std::vector<LitPrimitive>& primitives, LightmapCharts& charts) {
  struct Sum {
    double power = 0.0, area = 0.0;
    double mean() const { return area > 0.0 ? power / area : 0.0; }
  };
  std::vector<Sum> of_chart(charts.charts.size());
  Sum all;
  for (const LitPrimitive& p : primitives)
    for (std::size_t i = 0; i < p.triangles.size(); ++i) {
      const auto& v = p.triangles[i];
      const Vec3 a = p.positions[v[0]];
      const auto area = static_cast<double>(
          glm::length(glm::cross(p.positions[v[1]] - a, p.positions[v[2]] - a)));
      const Rgb sum = p.irradiance[v[0]] + p.irradiance[v[1]] + p.irradiance[v[2]];
      for (Sum* s : {&all, &of_chart[charts.of({p.sources[i], p.back}).value]}) {
        s->power += area * static_cast<double>(average(sum)) / 3.0;
        s->area += area;
      }
    }
  for (std::size_t i = 0; i < of_chart.size(); ++i) {
    LightmapChart& chart = charts.charts[ChartId(i)];
    if (emits(scene, g, chart.faces.front()))
      chart.detail = kDetailOfEmitters;
    else if (of_chart[i].mean() < kDark * all.mean())
      chart.detail = kDetailInTheDark;
  }
}

void add_seams(const Geometry& g, const FaceList& faces, const FaceNeighbours& neighbours,
               LightmapCharts& charts) {
  charts.borders.resize(g.triangles.size(), {0, 0});
  for (const std::uint32_t n : faces) {
    const TriangleFace f = face_of(n);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = neighbours.of(n)[k];
      if (next == FaceNeighbours::kNone) {
        charts.borders[f.triangle][f.back ? 1 : 0] |= static_cast<std::uint8_t>(1u << k);
        continue;
      }
      const ChartId here = charts.of(f), there = charts.of(face_of(next));
      if (n < next && here != there) charts.seams.push_back({{here, there}, side_of_face(g, f, k)});
    }
  }
}

}  // namespace

LightmapCharts make_charts(const Scene& scene, const Geometry& g,
                           const std::vector<LitPrimitive>& primitives, double texels) {
  const IdVector<TriangleId, ShownSides> shown = shown_in(g, primitives);
  FaceList faces;
  double area = 0.0;
  for (std::uint32_t n = 0; n < 2 * g.triangles.size(); ++n) {
    const TriangleFace f = face_of(n);
    if (!(f.back ? shown[f.triangle].back : shown[f.triangle].front)) continue;
    faces.push_back(n);
    area += static_cast<double>(g.area(f.triangle));
  }
  const SharedEdges edges(g, weld(g));
  const FaceNeighbours neighbours(g, edges, shown);
  const std::vector<FaceList> grown = grow_charts(scene, g, faces, neighbours);
  const auto square = static_cast<float>(std::sqrt(area / std::max(1.0, texels)));

  std::vector<std::vector<LightmapChart>> cut(grown.size());
  parallel_for(grown.size(), 1,
               [&](std::size_t i) { cut[i] = without_overlaps(g, grown[i], neighbours, square); });
  LightmapCharts result;
  result.of_face.resize(g.triangles.size());
  for (auto& parts : cut)
    for (LightmapChart& chart : parts) {
      const ChartId id = result.charts.push_back(std::move(chart));
      for (const TriangleFace f : result.charts[id].faces)
        result.of_face[f.triangle][f.back ? 1 : 0] = id;
    }
  choose_detail(scene, g, primitives, result);
  add_seams(g, faces, neighbours, result);
  return result;
}

}  // namespace halflight
