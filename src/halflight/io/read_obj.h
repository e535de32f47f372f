// Wavefront OBJ with its MTL libraries.
#pragma once

#include <filesystem>

#include "halflight/io/read_file.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Objects and groups become meshes, each under a node of its own, in the order of their first face;
// faces of one material become one primitive. `path` names the text in messages and tells where its
// libraries lie. Throws ReadFailure.
Scene read_obj(Bytes text, const std::filesystem::path& path);

}  // namespace halflight
