#include "halflight/scene/summary.h"

#include <algorithm>
#include <array>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

// Weights of the 2nd and 3rd corner: the centroid and a point towards each corner.
constexpr std::array<Vec2, 4> kPoints = {Vec2(1.f / 3.f, 1.f / 3.f), Vec2(0.6f, 0.2f),
                                         Vec2(0.2f, 0.6f), Vec2(0.2f, 0.2f)};

template <class Value>
Rgb mean_over_points(bool textured, const Value& value) {
  if (!textured) return value(kPoints[0]);
  Rgb sum(0.f);
  for (const Vec2& point : kPoints) sum += value(point);
  return sum / static_cast<float>(kPoints.size());
}

// Area-weighted sums over triangles of one material.
struct MaterialSums {
  std::size_t triangles = 0;
  double area = 0.0;
  glm::dvec3 radiance{0.0};  // x area
};

IdVector<MaterialId, MaterialSums> sum_emission(const Scene& scene, const Geometry& g) {
  IdVector<MaterialId, MaterialSums> sums(scene.materials.size());
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    const Material& m = scene.materials[g.materials[t]];
    if (!m.emits()) continue;
    const double area = static_cast<double>(g.area(t));
    MaterialSums& sum = sums[g.materials[t]];
    ++sum.triangles;
    sum.area += area;
    sum.radiance += area * glm::dvec3(mean_over_points(m.emission_texture.valid(), [&](Vec2 b) {
                      return emission_at(scene, g, t, b);
                    }));
  }
  return sums;
}

struct AreaSum {
  double area = 0.0;        // of everything
  double reflecting = 0.0;  // of what does not emit
  glm::dvec3 reflectance{0.0};
  AreaSum& operator+=(const AreaSum& o) {
    area += o.area;
    reflecting += o.reflecting;
    reflectance += o.reflectance;
    return *this;
  }
};

AreaSum sum_reflectance(const Scene& scene, const Geometry& g) {
  return parallel_sum(g.triangles.size(), 4096, AreaSum(), [&](std::size_t i) {
    const TriangleId t(i);
    const Material& m = scene.materials[g.materials[t]];
    AreaSum sum;
    sum.area = static_cast<double>(g.area(t));
    if (m.emits()) return sum;
    sum.reflecting = sum.area;
    sum.reflectance =
        sum.area * glm::dvec3(mean_over_points(m.reflectance_texture.valid(), [&](Vec2 b) {
          return reflectance_at(scene, g, t, b);
        }));
    return sum;
  });
}

std::vector<EmitterSummary> summarize_emitters(const Scene& scene, const Geometry& g) {
  const IdVector<MaterialId, MaterialSums> sums = sum_emission(scene, g);
  std::vector<EmitterSummary> emitters;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const MaterialId id(i);
    const MaterialSums& sum = sums[id];
    if (sum.triangles == 0) continue;
    const double sides = scene.materials[id].double_sided ? 2.0 : 1.0;
    emitters.push_back({id, sum.triangles, sum.area, Rgb(sum.radiance / sum.area),
                        Rgb(sides * static_cast<double>(kPi) * sum.radiance)});
  }
  std::ranges::stable_sort(emitters, std::greater<>(),
                           [](const EmitterSummary& e) { return luminance(e.power); });
  return emitters;
}

}  // namespace

SceneSummary summarize(const Scene& scene, const Geometry& g) {
  SceneSummary summary;
  summary.triangles = g.triangles.size();
  summary.degenerate_triangles = g.degenerate_triangles;
  summary.vertices = g.positions.size();
  summary.instances = g.primitive_instances.size();
  for (const Texture& texture : scene.textures) summary.texels += texture.texels.size();
  summary.bounds = g.bounds;
  const AreaSum sum = sum_reflectance(scene, g);
  summary.area = sum.area;
  if (sum.reflecting > 0.0) summary.reflectance = Rgb(sum.reflectance / sum.reflecting);
  summary.emitters = summarize_emitters(scene, g);
  for (const EmitterSummary& emitter : summary.emitters) summary.emitted_power += emitter.power;
  return summary;
}

}  // namespace halflight
