// KHR_draco_mesh_compression: whole primitives compressed by Draco.
#pragma once

#include "halflight/io/gltf_document.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Fills in the vertices and triangles of a primitive from the buffer view that `extension` (the
// extension object of the primitive `json`) names. Throws ReadFailure.
void read_draco(GltfDocument& document, const JsonCursor& json, const JsonCursor& extension,
                Primitive& primitive);

}  // namespace halflight
