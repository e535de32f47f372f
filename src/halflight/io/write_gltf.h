// Writes GLB files: scenes as they are, and lit ones (design contract 1.3).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/scene.h"

namespace halflight {

// One side of one primitive instance with light at its vertices, in world space (metres, +Y up).
struct LitPrimitive {
  InstanceId instance;
  bool back = false;  // shows the back of the surface; emission leaves it only if double-sided
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                            // unit, towards the side that is shown
  std::array<std::vector<Vec2>, 2> uvs;                 // empty when the source primitive has none
  std::vector<Vec2> lightmap_uvs;                       // empty: there is no lightmap
  std::vector<Rgb> irradiance;                          // E on the side that `normals` point to
  std::vector<Rgb> indirect;                            // the reflected part of E; may be empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from that side
  std::vector<TriangleId> sources;  // the input triangle each lies in, ascending; may be empty
};

// A picture of the irradiance beside a lit scene, for extras.
struct LightmapFile {
  std::string name;  // relative to the scene's folder
  int size = 0;      // texels a side
};

// Output files appear whole or not at all.
Result<void> write_scene_glb(const std::filesystem::path& path, const Scene& scene);

// COLOR_0 = clamp(exposure E / pi) and _IRRADIANCE = E, under KHR_materials_unlit, so that viewers
// show base colour x COLOR_0 = exposure x rho E / pi. Where a surface emits, base colour and
// COLOR_0 are chosen to show exposure x (rho E / pi + L). The file is in metres, +Y up; each lit
// primitive lies in the local space of its node. `exposure` is recorded in the extras of asset and
// scene. Places in a lightmap go to TEXCOORD_1; where a material's textures need that set, to
// TEXCOORD_2, and the material's extras say so.
Result<void> write_lit_glb(const std::filesystem::path& path, const Scene& scene,
                           const Geometry& geometry, const std::vector<LitPrimitive>& primitives,
                           float exposure, const LightmapFile& lightmap = {});

}  // namespace halflight
