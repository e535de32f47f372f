// Parts of a glTF document that plain and lit scenes share: textures, cameras, lights, nodes.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "halflight/io/glb_builder.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Writes each texture once, when something first refers to it.
class TextureWriter {
 public:
  TextureWriter(const Scene& scene, GlbBuilder& glb) : scene_(scene), glb_(glb) {}

  // A textureInfo object.
  nlohmann::json info(const TextureRef& ref);
  // The base colour textureInfo of a material, its separate alpha texture (OBJ map_d) merged into
  // the alpha channel; null when the material has neither.
  nlohmann::json base_color(const Material& material);

 private:
  int texture(TextureId id);
  int merged(TextureId color, TextureId alpha);
  nlohmann::json placed(int index, const TextureRef& ref);
  const Texture* picture(TextureId id) const;  // null: none, or not readable
  int add(const Texture& t, const std::vector<std::uint8_t>& encoded, const std::string& mime_type);

  const Scene& scene_;
  GlbBuilder& glb_;
  std::map<std::pair<TextureId, TextureId>, int> written_;  // by colour and alpha texture
};

// m = translation * rotation * scale, the only matrices glTF nodes and instances may have.
struct Trs {
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 scale{1.0};
};
// Nothing when the axes are skewed, vanish or are not finite.
std::optional<Trs> decompose(const Mat4& m);

nlohmann::json camera_json(const Camera& camera);
nlohmann::json light_json(const Light& light);

// Fills in name, matrix, camera and light of a node; the matrix is left out when it is identity.
nlohmann::json node_json(const Node& node, const Mat4& local, GlbBuilder& glb);
// Appends cameras and lights of the scene; node_json refers to them by id.
void write_cameras_and_lights(const Scene& scene, GlbBuilder& glb);

// How many TEXCOORD sets the textures of a material ask for (0 to 2).
int uv_sets_needed(const Material& material);

}  // namespace halflight
