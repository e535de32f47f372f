// Reading the light: vertices, texels, sensors and pixels all ask this.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// A place on a surface where light is read, on the side that the normal points to.
struct ReadingPoint {
  Vec3 position{0.f};
  Vec3 normal{0.f, 1.f, 0.f};  // unit; may be a shading normal
  TriangleId triangle;         // the surface it lies on; invalid: none in particular
  bool direct_only = false;    // the indirect part is known from elsewhere
};

// Irradiance E = direct + indirect, W/m2 (or lux), at one point.
struct Reading {
  Rgb direct{0.f};    // from emitters, punctual lights and sky
  Rgb indirect{0.f};  // reflected at least once
  Rgb irradiance() const { return direct + indirect; }
};

// Reads many points at once (in parallel, in any number); results in the order of the points.
using LightReader = std::function<std::vector<Reading>(std::span<const ReadingPoint>)>;

}  // namespace halflight
