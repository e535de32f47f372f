// Wavefront OBJ with its MTL libraries.
#pragma once

#include <filesystem>

#include "halflight/scene/scene.h"

namespace halflight {

// Objects and groups become meshes, each under a node of its own, in the order of their first face;
// faces of one material become one primitive. Throws ReadFailure.
Scene read_obj(const std::filesystem::path& path);

}  // namespace halflight
