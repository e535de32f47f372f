// What is done with every scene that could be read, up to what `halflight inspect` does.
#pragma once

#include "fuzz_target.h"
#include "halflight/io/load_scene.h"
#include "halflight/scene/lint.h"
#include "halflight/scene/summary.h"

namespace halflight::fuzz {

inline void require_sound(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& p : mesh.primitives) {
      require(scene.materials.contains(p.material), "primitives have a material");
      for (const auto& corners : p.triangles)
        for (const std::uint32_t v : corners)
          require(v < p.positions.size(), "corners are vertices");
      for (const Vec3& x : p.positions) require(is_finite(x), "vertices are finite");
      require(p.normals.empty() || p.normals.size() == p.positions.size(), "a normal per vertex");
      for (const auto& uv : p.uvs)
        require(uv.empty() || uv.size() == p.positions.size(), "coordinates per vertex");
    }
  for (const Material& m : scene.materials) {
    require(is_finite(m.reflectance) && is_finite(m.emission), "colours are finite");
    for (const TextureRef* t : {&m.reflectance_texture, &m.emission_texture, &m.alpha_texture})
      require(!t->valid() || scene.textures.contains(t->texture), "textures are there");
  }
  for (const Texture& t : scene.textures)
    require(t.texels.empty() || t.texels.size() == static_cast<std::size_t>(t.width) *
                                                       static_cast<std::size_t>(t.height),
            "textures are whole");
}

inline void inspect(const Result<Scene>& scene) {
  if (!scene) return require_clear(scene.error());
  require_sound(*scene);
  const Geometry geometry = flatten(*scene);
  const SceneSummary summary = summarize(*scene, geometry);
  for (const Finding& finding : lint(*scene, geometry, summary)) require_line(finding.message);
  for (const std::string& warning : scene->warnings) require_line(warning);
}

}  // namespace halflight::fuzz
