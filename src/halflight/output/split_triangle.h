// Templates that cut a triangle at the middles of its sides.
#pragma once

#include <array>
#include <vector>

#include "halflight/output/work_mesh.h"

namespace halflight {

// Side k runs from corner k to corner k + 1. Side 0 is the longest and always split; the middles of
// sides that are not split are invalid.
struct SplitTriangle {
  std::array<LitVertexId, 3> corners;
  std::array<LitVertexId, 3> middles;
  bool obtuse = false;  // at corner 2
};

// With corners a b c and middles x y z:
//   x        a x c, x b c
//   x y      a x c, x b y, x y c
//   x z      x b c, a x z, x c z
//   x y z    a x z, x b y, and z y c, x y z (four alike), or x y c, x c z where c is obtuse
inline std::vector<std::array<LitVertexId, 3>> parts_of(const SplitTriangle& t) {
  const auto [a, b, c] = t.corners;
  const auto [x, y, z] = t.middles;
  if (y.valid() && z.valid()) {
    if (t.obtuse) return {{a, x, z}, {x, b, y}, {x, y, c}, {x, c, z}};
    return {{a, x, z}, {x, b, y}, {z, y, c}, {x, y, z}};
  }
  if (y.valid()) return {{a, x, c}, {x, b, y}, {x, y, c}};
  if (z.valid()) return {{x, b, c}, {a, x, z}, {x, c, z}};
  return {{a, x, c}, {x, b, c}};
}

}  // namespace halflight
