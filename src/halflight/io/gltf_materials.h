// Materials and textures of glTF scenes.
#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "halflight/io/gltf_document.h"
#include "halflight/io/pictures.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Reads materials when primitives ask for them; pictures that no material shows are never opened.
//   baseColorFactor x baseColorTexture                  reflectance; metallic is ignored
//   emissiveFactor x emissiveTexture x emissiveStrength radiance
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, Scene& scene, ReadWarnings& warnings)
      : document_(document), scene_(scene), warnings_(warnings) {}

  MaterialId read(const JsonCursor& index);
  // glTF's default material, for primitives without one: white.
  MaterialId default_material();
  // To be called once, when all materials are read.
  void decode_textures() { decode_pictures(pictures_, scene_, warnings_); }

 private:
  Material read_material(const JsonCursor& json);
  void read_base_colour(const JsonCursor& json, Material& material);
  void read_emission(const JsonCursor& json, Material& material);
  TextureRef read_texture_ref(const JsonCursor& info);
  TextureId read_texture(const JsonCursor& index);
  std::size_t picture(const JsonCursor& image_index);

  GltfDocument& document_;
  Scene& scene_;
  ReadWarnings& warnings_;
  std::map<std::size_t, MaterialId> material_of_index_;
  MaterialId default_;
  std::vector<Picture> pictures_;
  std::map<std::size_t, std::size_t> picture_of_image_;
  std::map<std::pair<const std::uint8_t*, std::size_t>, std::size_t> picture_of_bytes_;
  std::map<std::tuple<std::size_t, Wrap, Wrap>, TextureId> texture_of_key_;  // image and wraps
};

}  // namespace halflight
