// What a hierarchy builder knows of a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "halflight/hierarchy/surfaces.h"

namespace halflight {

struct SurfaceShape {
  Bounds3f box;
  Vec3 normal{0.f};  // unit, of the front side
  float area = 0.f;
  std::uint32_t object = 0;  // the same for all surfaces of one connected body
};

std::vector<SurfaceShape> surface_shapes(const Surfaces& surfaces);

}  // namespace halflight
