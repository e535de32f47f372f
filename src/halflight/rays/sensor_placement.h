// Where a sensor reads: the side of the nearest surface that its normal faces.
#pragma once

#include "halflight/base/vec.h"
#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"

namespace halflight {

struct SensorPlacement {
  Vec3 position{0.f};          // on the surface; as given in the air
  Vec3 normal{0.f, 1.f, 0.f};  // unit; geometric, of the side that is read
  TriangleId triangle;         // invalid: the sensor hangs in the air
  Vec2 barycentric{0.f};       // weights of the triangle's 2nd and 3rd corner
  bool front = true;           // reads the counter-clockwise side
};

// `normal` is unit. Sensors may lie a little above or under their surface: written and transformed
// coordinates are rounded, and bent quads can be cut along either diagonal. Surfaces further away
// than `sensor_reach` are not meant; nor are those that lean away from the normal by more than 60
// degrees (the wall behind a sensor in the corner of a floor). Of surfaces at the same distance the
// one that leans least is taken, and of a stack of layers thinner than a few rounding errors
// (panels laid on a ceiling) the outermost, which hides the others from every ray.
SensorPlacement place_sensor(const Geometry& geometry, const RayScene& rays, const Vec3& position,
                             const Vec3& normal);

// Metres: 1/10,000 of the scene's diagonal, and never less than a few rounding errors.
float sensor_reach(const Geometry& geometry, const RayScene& rays);

// Barycentric weights (of corners 2 and 3) of the point of a triangle closest to p.
Vec2 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace halflight
