// The MTL half of OBJ scenes.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/io/pictures.h"
#include "halflight/io/read_failure.h"
#include "halflight/io/read_file.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Collects the materials of any number of MTL files into a scene.
//   map_Kd, else Kd  reflectance (without either: that of Material)
//   Ke x map_Ke      radiance
//   d or 1 - Tr, x map_d    opacity; d counts when both are given
// Everything else (Ka, Ks, illum, bump, ...) does not concern diffuse light.
class ObjMaterials {
 public:
  ObjMaterials(Scene& scene, ReadWarnings& warnings) : scene_(scene), warnings_(warnings) {}

  // Adds the materials of one file, once however often it is asked for. A missing file is a
  // warning.
  void read_library(const std::filesystem::path& path);
  void read_library(Bytes text, const std::filesystem::path& path);
  // The named material; one with default values (and a warning) when no library has it.
  MaterialId find_or_add(std::string_view name);
  // The material of faces before any usemtl.
  MaterialId unnamed();
  // To be called once, when all libraries are read.
  void decode_textures();

 private:
  void read_maps(std::string_view key, std::string_view arguments,
                 const std::filesystem::path& folder, Material& material);
  TextureRef read_map(std::string_view arguments, const std::filesystem::path& folder,
                      Picture::Use use);
  TextureId texture(const std::filesystem::path& path, Wrap wrap, Picture::Use use);

  Scene& scene_;
  ReadWarnings& warnings_;
  std::set<std::filesystem::path> libraries_;
  std::map<std::string, MaterialId, std::less<>> by_name_;
  std::vector<Picture> pictures_;
  std::map<std::string, std::size_t> picture_of_path_;
  std::map<std::string, TextureId> texture_of_key_;
};

}  // namespace halflight
