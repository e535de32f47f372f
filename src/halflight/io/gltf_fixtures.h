// Lights and cameras of glTF scenes.
#pragma once

#include <map>

#include "halflight/io/gltf_document.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Reads them when nodes ask for them. Members throw ReadFailure.
class GltfFixtures {
 public:
  GltfFixtures(const GltfDocument& document, Scene& scene) : document_(document), scene_(scene) {}

  CameraId camera(const JsonCursor& index);
  LightId light(const JsonCursor& index);  // into the array of KHR_lights_punctual

 private:
  const GltfDocument& document_;
  Scene& scene_;
  std::map<std::size_t, CameraId> camera_of_index_;
  std::map<std::size_t, LightId> light_of_index_;
};

}  // namespace halflight
