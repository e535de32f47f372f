// The pictures that a scene's textures show: gathered while the materials are read, then decoded in
// parallel, each once.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "halflight/io/read_failure.h"
#include "halflight/io/read_file.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct Picture {
  enum class Use {
    colour,   // texels as they are
    opacity,  // OBJ map_d: its alpha channel if it has one, else its red channel, moved to alpha
  };
  struct Shown {
    TextureId texture;
    Use use = Use::colour;
  };
  std::string where;  // for messages
  Bytes owned;        // its file, or empty when `bytes` lies elsewhere
  std::span<const std::uint8_t> bytes;
  std::string missing;  // why there are no bytes at all; empty: there are
  std::vector<Shown> shown;
};

// Fills the textures in. A picture that cannot be decoded leaves its textures without texels
// (a factor of one) and a warning.
void decode_pictures(std::span<Picture> pictures, Scene& scene, ReadWarnings& warnings);

}  // namespace halflight
