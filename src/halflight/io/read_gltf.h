// glTF 2.0 and GLB.
#pragma once

#include <filesystem>

#include "halflight/io/read_file.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Reads the default scene (else the first; without any, every root node). `path` names the
// file in messages and tells where its buffers and pictures lie. Throws ReadFailure.
// Understood besides the core: KHR_materials_emissive_strength, _transmission, _unlit and
// _pbrSpecularGlossiness (its diffuse part), KHR_texture_transform, KHR_lights_punctual,
// KHR_mesh_quantization, EXT_mesh_gpu_instancing, KHR_draco_mesh_compression,
// EXT_meshopt_compression. Animation, skins and morph targets stay at rest.
Scene read_gltf(Bytes file, const std::filesystem::path& path);

}  // namespace halflight
