// Where a shown surface continues smoothly from one triangle to the next.
#pragma once

#include <cstddef>
#include <cstdint>

#include "halflight/output/shown_sides.h"
#include "halflight/output/weld.h"

namespace halflight {

// One side of a triangle. The corners of a back run the other way round: 0, 2, 1.
struct TriangleFace {
  TriangleId triangle;
  bool back = false;
};

// Corner k of a face is this corner of its triangle.
inline std::size_t source_corner(bool back, std::size_t k) { return back ? (3 - k) % 3 : k; }

struct FaceCorner {
  Vec3 normal{0.f};    // shading normal, on the side of the face
  bool given = false;  // from the file
  float angle = 0.f;
  Vec3 inwards{0.f};  // unit, to the centroid
};
FaceCorner measure_corner(const Geometry& geometry, TriangleFace face, std::size_t k);

// The surface is one and the same at two corners that share a point: their normals nearly agree.
bool continues(const FaceCorner& a, const FaceCorner& b);

// Calls visit(face a, side of a, face b, side of b) for the faces that look the same way from both
// sides of an edge that exactly two triangles share. Side k of a face runs from its corner k to
// k + 1; the sides of the two run in opposite directions. `shown` says which faces there are.
template <class Visit>
void for_each_joint(const SharedEdges& edges, const IdVector<TriangleId, ShownSides>& shown,
                    const Visit& visit) {
  const auto is_shown = [&](TriangleFace f) {
    return f.back ? shown[f.triangle].back : shown[f.triangle].front;
  };
  edges.for_each([&](std::span<const TriangleSide> sides) {
    if (sides.size() != 2) return;
    const bool same_winding = sides[0].upwards != sides[1].upwards;
    for (const bool back : {false, true}) {
      const TriangleFace a{sides[0].triangle, back};
      const TriangleFace b{sides[1].triangle, same_winding ? back : !back};
      if (!is_shown(a) || !is_shown(b)) continue;
      // Side k of a triangle is side 2 - k of its back.
      const std::uint32_t side_a = a.back ? 2u - sides[0].side : sides[0].side;
      const std::uint32_t side_b = b.back ? 2u - sides[1].side : sides[1].side;
      visit(a, side_a, b, side_b);
    }
  });
}

}  // namespace halflight
