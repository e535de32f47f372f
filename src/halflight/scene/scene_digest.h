// A fingerprint of all that the light in a scene depends on.
#pragma once

#include <cstdint>

#include "halflight/scene/scene.h"

namespace halflight {

// Of what is where, of which material, and what shines; not of names, cameras or the texture files'
// own bytes.
std::uint64_t digest_of(const Scene& scene);

}  // namespace halflight
