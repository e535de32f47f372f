// Which sides of surfaces can ever see light: the others get no element and cost nothing.
#pragma once

#include <cstdint>

#include "halflight/base/ids.h"
#include "halflight/hierarchy/surfaces.h"
#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Dead sides are the insides of closed opaque bodies that hold nothing else (closedness by
// topology, emptiness by rays), of bodies that together with what they stand on let no random walk
// out, and sides of large surfaces from which every ray leaves the scene when nothing shines from
// outside. In doubt a side is live.
IdVector<SideId, std::uint8_t> find_live_sides(const Scene& scene, const Geometry& geometry,
                                               const Surfaces& surfaces, const RayScene& rays);

}  // namespace halflight
