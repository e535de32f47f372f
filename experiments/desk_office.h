// The office of figures 7 and 8: desks, chairs and small objects, of about 5,400 polygons.
#pragma once

#include <vector>

#include "halflight/scene/scene.h"

namespace halflight::experiments {

// A rectangle that shines down, seen from below.
struct CeilingLight {
  Vec3 center{0.f};
  Vec2 half{0.f};  // along x and z
};

// The paper's office came from the Berkeley Soda Hall model and was not published. This one is put
// together from the furniture of the procedural office.
struct DeskOffice {
  Scene scene;
  std::vector<CeilingLight> lights;
  std::vector<Vec3> under_desks;  // places on the floor between the legs and drawers of each desk
};
DeskOffice desk_office();

}  // namespace halflight::experiments
