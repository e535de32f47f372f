// Groups of cubes between a small square light and a wall, after the scene with which the report
// (Sillion and Drettakis, INRIA RR-2503, section 4) measures feature-based error: each group throws
// shadows of one width. One unit of that scene is one centimetre here.
//   wall 200 x 200 at z = 0, light 4 x 4 at z = D; cubes of edge a = w (D - 55) / D for shadows of
//   width w = 11, 16.5, 22, 31, round(0.8 160^2 / a^2) of them, axis-aligned and apart from each
//   other, in the slab 30 <= z <= 80 over the central 160 x 160;
//   fewer (of the largest) where 200,000 random tries find no more room.
// One group alone has D = 300; all four stand side by side before a wall of 800 x 200 with D = 600.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct CubeGroupsParameters {
  int group = 0;            // 1 to 4, small to large shadows; 0: all four side by side
  float reflectance = 0.f;  // of the cubes; black ones leave the wall with direct light only
  int seed = 1;
};

Knobs knobs(CubeGroupsParameters& p);
Scene cube_groups_scene(const CubeGroupsParameters& p = {});

}  // namespace halflight
