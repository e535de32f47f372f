// A triangle as seen from a point: the part of the unit sphere that it covers.
#pragma once

#include <array>

#include "halflight/base/vec.h"

namespace halflight {

// Directions uniform in solid angle (Arvo 1995, "Stratified Sampling of Spherical Triangles").
// Single precision serves solid angles above about 1e-3 sr.
class SphericalTriangle {
 public:
  // Corners relative to the point from which they are seen; none of them there.
  explicit SphericalTriangle(const std::array<Vec3, 3>& corners);

  float solid_angle() const { return solid_angle_; }  // sr; 0 when degenerate
  const Vec3& corner(int i) const { return corners_[static_cast<std::size_t>(i)]; }  // unit
  // u.y = 0 gives the 2nd corner, (0, 1) the 1st, (1, 1) the 3rd.
  Vec3 direction(Vec2 u) const;

 private:
  std::array<Vec3, 3> corners_;
  Vec3 towards_third_{0.f};  // unit, perpendicular to the first corner, in the plane of 1 and 3
  float cos_first_ = 0.f, sin_first_ = 0.f, first_ = 0.f;  // angle at the first corner
  float cos_side_ = 0.f;  // of the arc between the first two corners
  float solid_angle_ = 0.f;
};

// A point of the unit square with density proportional to the bilinear interpolation of positive
// weights at (0,0), (1,0), (0,1), (1,1), and that density.
struct WarpedPoint {
  Vec2 u{0.f};
  float density = 1.f;
};
WarpedPoint sample_bilinear(Vec2 u, const std::array<float, 4>& weights);

}  // namespace halflight
