// Plain shapes as triangles, appended to a primitive with normals. Front faces are
// counter-clockwise.
#pragma once

#include <array>
#include <span>

#include "halflight/base/vec.h"
#include "halflight/scene/scene.h"

namespace halflight {

void append_triangle(Primitive& to, const Vec3& a, const Vec3& b, const Vec3& c);
// Planar and convex; corners counter-clockwise seen from the front.
void append_quad(Primitive& to, const std::array<Vec3, 4>& corners);

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr std::array kAllSides{Side::x_low,  Side::x_high, Side::y_low,
                                      Side::y_high, Side::z_low,  Side::z_high};
enum class Facing { outwards, inwards };

// Corners of one side of a box, counter-clockwise seen from where it faces.
std::array<Vec3, 4> side_of(const Bounds3f& box, Side side, Facing facing = Facing::outwards);
void append_box(Primitive& to, const Bounds3f& box);  // closed, faces outwards

// A profile of points (radius, height) turned about `axis` (unit) through `base`. Listed from the
// bottom up along the outside; starting and ending at radius 0 makes it closed. Smooth around the
// axis, with an edge at each profile point.
void append_revolution(Primitive& to, const Vec3& base, const Vec3& axis,
                       std::span<const Vec2> profile, int sides);
// Closed round rod between two points.
void append_rod(Primitive& to, const Vec3& from, const Vec3& end, float radius, int sides);
// Open-topped round vessel with a wall of a given thickness, standing on `base`.
struct Vessel {
  float bottom_radius = 0.f;
  float top_radius = 0.f;
  float height = 0.f;
  float wall = 0.f;
};
void append_vessel(Primitive& to, const Vec3& base, const Vessel& vessel, int sides);

// Box whose outline seen from above has corners of radius `round` and whose upper and lower edges
// are cut at 45 degrees by `bevel`. Closed, flat shaded.
void append_cushion(Primitive& to, const Bounds3f& box, float round, float bevel);

// Copies `part`, moved by a transform without mirroring.
void append_moved(Primitive& to, const Primitive& part, const Mat4& transform);

}  // namespace halflight
