// How brightly anything in a scene may shine.
#pragma once

#include "halflight/base/vec.h"

namespace halflight {

// W/m2/sr, candela or lux in any channel: more is a mistake, and floats hold all that comes of
// less.
inline constexpr float kMaxRadiance = 1e12f;

inline bool is_radiance(const Rgb& c) {
  return is_finite(c) && min_component(c) >= 0.f && max_component(c) <= kMaxRadiance;
}

}  // namespace halflight
