// What a scene comes to once every instance is placed.
#pragma once

#include <string>

#include "halflight/scene/scene.h"

namespace halflight {

// Throws ReadFailure when placing every instance would pass the limits of scene_limits.h.
void check_placed_size(const Scene& scene, const std::string& where);

}  // namespace halflight
