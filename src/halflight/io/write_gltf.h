// Writes GLB files: scenes as they are, and lit ones (design contract 1.3).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/scene.h"

namespace halflight {

// One primitive instance with light at its vertices. Positions and normals are in world space.
struct LitPrimitive {
  InstanceId instance;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::array<std::vector<Vec2>, 2> uvs;  // empty when the source primitive has none
  std::vector<Rgb> irradiance;           // E on the side that `normals` point to
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Output files appear whole or not at all.
Result<void> write_scene_glb(const std::filesystem::path& path, const Scene& scene);

// COLOR_0 = clamp(exposure * E / pi) under KHR_materials_unlit, _IRRADIANCE = E.
Result<void> write_lit_glb(const std::filesystem::path& path, const Scene& scene,
                           const Geometry& geometry, const std::vector<LitPrimitive>& primitives,
                           float exposure);

}  // namespace halflight
