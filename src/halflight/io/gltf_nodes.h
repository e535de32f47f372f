// The node tree of a glTF scene, with what hangs on it.
#pragma once

#include <vector>

#include "halflight/io/gltf_document.h"
#include "halflight/io/gltf_meshes.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Adds the nodes of the default scene, parents first, with their meshes, lights and cameras. Throws
// ReadFailure when the nodes (in any scene) do not form trees.
void read_gltf_nodes(GltfDocument& document, GltfMeshes& meshes, Scene& scene,
                     ReadWarnings& warnings);

}  // namespace halflight
