// Light of a solution as a picture on the lit mesh: a lightmap.
#pragma once

#include <functional>

#include "halflight/base/image.h"
#include "halflight/base/progress.h"
#include "halflight/output/light_reader.h"
#include "halflight/output/lightmap_texels.h"

namespace halflight {

// What texels ask.
struct LightmapLight {
  LightReader read;  // asked for direct light only: the rest comes from the lit mesh
  // Points inside of closed bodies that stand on the surface: nobody sees them.
  std::function<std::vector<std::uint8_t>(std::span<const ReadingPoint>)> covered;
};

struct Lightmap {
  Image irradiance;  // E, W/m2, linear; black where no chart is
  LightmapCharts charts;
  LightmapLayout layout;
  std::size_t read = 0;         // texels
  std::size_t covered = 0;      // of which lie inside of other bodies
  float mean_irradiance = 0.f;  // over texels, all channels
  // At seams, RMS relative to the mean: as read, and after matching.
  float seam_difference_as_read = 0.f, seam_difference = 0.f;
};

// Cuts the lit mesh into charts, packs them, gives its vertices their places in the map
// (LitPrimitive::lightmap_uvs), and reads the light: direct light at the centre of every texel,
// indirect light as the mesh has it. Texels inside of other bodies take the light of the nearest
// that are not; where bodies are not closed, those along their outline do, by being black. Padding
// continues the light of its chart. Deterministic.
Result<Lightmap> bake_lightmap(const Scene& scene, const Geometry& geometry,
                               std::vector<LitPrimitive>& primitives, const LightmapLight& light,
                               float feature_size, int size, const Progress& progress = {});

}  // namespace halflight
