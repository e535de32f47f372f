// From pixels to rays.
#pragma once

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

struct CameraRay {
  Vec3 origin{0.f};
  Vec3 direction{0.f, 0.f, -1.f};  // unit
};

// Pictures have row 0 at the top; pixel (i, j) covers [i, i+1) x [j, j+1). The picture's height
// covers the camera's vertical field of view and pixels are square: the camera's own aspect ratio
// only proposes a size.
class CameraRays {
 public:
  CameraRays(const PlacedCamera& camera, int width, int height);
  // Position in pixels, from the top left corner of the picture.
  CameraRay through(Vec2 pixel) const;

 private:
  PlacedCamera camera_;
  Vec3 right_, up_;  // from the picture's centre to its right and upper border, at distance 1
  Vec2 size_;
};

}  // namespace halflight
