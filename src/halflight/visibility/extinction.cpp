#include "halflight/visibility/extinction.h"

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr float kThickness = 1e-3f;            // of the box's diagonal
constexpr std::uint32_t kOpacitySamples = 32;  // of a textured triangle

constexpr int kNewtonSteps = 20;
constexpr float kFitTolerance = 1e-3f;
constexpr float kLeastLight = 1e-3f;  // of what covers everything

}  // namespace

float mean_opacity(const Scene& scene, const Geometry& g, TriangleId t) {
  const Material& m = scene.materials[g.materials[t]];
  if (!may_be_transparent(m)) return 1.f;
  if (!m.alpha_texture.valid() && !m.reflectance_texture.valid())
    return opacity_at(scene, g, t, Vec2(1.f / 3.f));
  float sum = 0.f;
  for (std::uint32_t i = 0; i < kOpacitySamples; ++i)
    sum += opacity_at(scene, g, t, uniform_triangle(r2_sequence(i)));
  return sum / static_cast<float>(kOpacitySamples);
}

IdVector<TriangleId, float> blocking_areas(const Scene& scene, const Geometry& g,
                                           const Bodies& bodies) {
  IdVector<TriangleId, float> areas(g.triangles.size());
  parallel_for(g.triangles.size(), 1024, [&](std::size_t i) {
    const TriangleId t(i);
    const float area = g.area(t);
    const float opacity = mean_opacity(scene, g, t);
    const float share = bodies.closed[bodies.of_triangle[t]] ? 0.25f * (2.f - opacity) : 0.5f;
    areas[t] = share * opacity * area;
  });
  return areas;
}

Bounds3f thickened(const Bounds3f& box) {
  const Vec3 least(kThickness * std::max(box.diagonal(), 1e-12f));
  const Vec3 missing = 0.5f * glm::max(least - box.extent(), Vec3(0.f));
  return {box.lower - missing, box.upper + missing};
}

// The mean of exp(-kappa l) falls and is convex in kappa, and is no less than exp(-kappa mean l):
// Newton's method from where that equals the transmittance rises to the answer without passing it.
float fit_extinction(std::span<const float> chords, float transmittance) {
  transmittance = std::max(transmittance, kLeastLight);
  if (transmittance >= 1.f || chords.empty()) return 0.f;
  float mean = 0.f;
  for (const float l : chords) mean += l / static_cast<float>(chords.size());
  if (!(mean > 0.f)) return 0.f;
  const float wanted = transmittance * static_cast<float>(chords.size());
  float kappa = -std::log(transmittance) / mean;
  for (int step = 0; step < kNewtonSteps; ++step) {
    float light = 0.f, slope = 0.f;
    for (const float l : chords) {
      const float t = std::exp(-kappa * l);
      light += t;
      slope += l * t;
    }
    if (light <= wanted * (1.f + kFitTolerance) || !(slope > 0.f)) break;
    kappa += (light - wanted) / slope;
  }
  return kappa;
}

}  // namespace halflight
