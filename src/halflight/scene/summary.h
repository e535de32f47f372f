// What is in a scene: counts, sizes, and who gives light.
#pragma once

#include <cstddef>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/scene.h"

namespace halflight {

// All surfaces of one emitting material.
struct EmitterSummary {
  MaterialId material;
  std::size_t triangles = 0;
  double area = 0.0;  // m2, one side
  Rgb radiance{0.f};  // area mean, W/m2/sr
  Rgb power{0.f};     // pi A L, W; both sides when the material is double-sided
};

struct SceneSummary {
  std::size_t triangles = 0;  // placed, without degenerate_triangles
  std::size_t degenerate_triangles = 0;
  std::size_t vertices = 0;   // placed
  std::size_t instances = 0;  // placed primitives
  std::size_t texels = 0;
  Bounds3f bounds;                       // metres
  double area = 0.0;                     // m2, one side of everything
  Rgb reflectance{0.f};                  // area mean of what does not emit
  std::vector<EmitterSummary> emitters;  // the most powerful first
  Rgb emitted_power{0.f};                // W, of surfaces
};

// Textured emission and reflectance are estimated from four points per triangle.
SceneSummary summarize(const Scene& scene, const Geometry& geometry);

}  // namespace halflight
