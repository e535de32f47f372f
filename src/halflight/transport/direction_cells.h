// All directions in cells of about equal size: the faces of a cube, each cut into squares seen
// under equal angles. A cell and the one opposite lie on one line.
#pragma once

#include <array>

#include "halflight/base/vec.h"

namespace halflight {

inline constexpr int kCellsPerEdge = 2;
inline constexpr int kDirectionCells = 6 * kCellsPerEdge * kCellsPerEdge;

namespace direction_cells {
// Between cells, and in their middles: tangents of the angle from the middle of a face.
inline constexpr std::array<float, kCellsPerEdge - 1> kBorders{0.f};
inline constexpr std::array<float, kCellsPerEdge> kMiddles{-0.414214f, 0.414214f};
}  // namespace direction_cells

// w of any length.
inline int direction_cell(const Vec3& w) {
  const Vec3 a = glm::abs(w);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  const float along = a[axis];
  const auto place = [&](float across) {
    int i = 0;
    for (const float border : direction_cells::kBorders) i += across > border * along ? 1 : 0;
    return i;
  };
  const int face = 2 * axis + (w[axis] < 0.f ? 1 : 0);
  return (face * kCellsPerEdge + place(w[(axis + 1) % 3])) * kCellsPerEdge +
         place(w[(axis + 2) % 3]);
}

// Unit direction through the middle of a cell.
inline Vec3 direction_of_cell(int cell) {
  const int face = cell / (kCellsPerEdge * kCellsPerEdge), axis = face / 2;
  Vec3 w(0.f);
  w[axis] = face % 2 == 0 ? 1.f : -1.f;
  w[(axis + 1) % 3] = direction_cells::kMiddles[cell / kCellsPerEdge % kCellsPerEdge];
  w[(axis + 2) % 3] = direction_cells::kMiddles[cell % kCellsPerEdge];
  return glm::normalize(w);
}

inline int opposite_cell(int cell) { return direction_cell(-direction_of_cell(cell)); }

}  // namespace halflight
