#include "halflight/io/gltf_extensions.h"

#include <algorithm>
#include <array>

namespace halflight {
namespace {

constexpr std::array<std::string_view, 10> kUnderstood = {
    "EXT_mesh_gpu_instancing",         "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",      "KHR_lights_punctual",
    "KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",      "KHR_materials_unlit",
    "KHR_mesh_quantization",           "KHR_texture_transform",
};

// These change gloss or tint, which diffuse light does not see.
constexpr std::array<std::string_view, 9> kHarmless = {
    "KHR_materials_anisotropy", "KHR_materials_clearcoat",   "KHR_materials_dispersion",
    "KHR_materials_ior",        "KHR_materials_iridescence", "KHR_materials_sheen",
    "KHR_materials_specular",   "KHR_materials_variants",    "KHR_materials_volume",
};

}  // namespace

void check_required_extensions(const JsonCursor& root) {
  const auto required = root.find("extensionsRequired");
  if (!required) return;
  for (std::size_t i = 0; i < required->size(); ++i) {
    const JsonCursor entry = (*required)[i];
    const std::string name = entry.string();
    if (std::ranges::count(kUnderstood, name) + std::ranges::count(kHarmless, name) == 0)
      entry.fail("the scene requires the extension " + name + ", which cannot be read",
                 "export it without " + name);
  }
}

}  // namespace halflight
