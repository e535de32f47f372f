#include "halflight/output/exposure.h"

#include <algorithm>
#include <vector>

namespace halflight {
namespace {

struct LitArea {
  float irradiance;  // brightest channel
  float area;
};

}  // namespace

float automatic_exposure(const Scene& scene, const Geometry& g,
                         std::span<const LitPrimitive> primitives, const ExposureOptions& options) {
  std::vector<LitArea> areas;
  double total = 0.0;
  for (const LitPrimitive& p : primitives) {
    const PrimitiveInstance& what = g.primitive_instances[p.instance];
    const MaterialId material = scene.meshes[what.mesh].primitives[what.primitive].material;
    if (scene.materials[material].emits()) continue;
    for (const auto& t : p.triangles) {
      const Vec3 a = p.positions[t[0]], b = p.positions[t[1]], c = p.positions[t[2]];
      const Rgb mean = (p.irradiance[t[0]] + p.irradiance[t[1]] + p.irradiance[t[2]]) / 3.f;
      const float brightest = max_component(mean);
      if (!(brightest > 0.f)) continue;
      areas.push_back({brightest, 0.5f * glm::length(glm::cross(b - a, c - a))});
      total += static_cast<double>(areas.back().area);
    }
  }
  if (areas.empty() || !(total > 0.0)) return 1.f;
  std::stable_sort(areas.begin(), areas.end(),
                   [](const LitArea& x, const LitArea& y) { return x.irradiance < y.irradiance; });
  double below = 0.0;
  for (const LitArea& a : areas) {
    below += static_cast<double>(a.area);
    if (below >= static_cast<double>(options.shown_share) * total)
      return options.level * kPi / a.irradiance;
  }
  return options.level * kPi / areas.back().irradiance;
}

}  // namespace halflight
