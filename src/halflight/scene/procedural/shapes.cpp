#include "halflight/scene/procedural/shapes.h"

#include <glm/matrix.hpp>

namespace halflight {
namespace {

std::uint32_t append_vertex(Primitive& to, const Vec3& position, const Vec3& normal) {
  to.positions.push_back(position);
  to.normals.push_back(normal);
  return static_cast<std::uint32_t>(to.positions.size() - 1);
}

// The band between two points of a profile; a point on the axis makes it a fan of triangles.
void append_band(Primitive& to, const Vec3& base, const Frame& frame, Vec2 low, Vec2 high,
                 int sides) {
  const Vec2 along = glm::normalize(high - low);
  const auto ring_vertex = [&](Vec2 at, float phi) {
    const Vec3 outwards = std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent;
    return append_vertex(to, base + at.x * outwards + at.y * frame.normal,
                         along.y * outwards - along.x * frame.normal);
  };
  const std::uint32_t first = static_cast<std::uint32_t>(to.positions.size());
  for (int i = 0; i <= sides; ++i) {
    const float phi = 2.f * kPi * static_cast<float>(i % sides) / static_cast<float>(sides);
    ring_vertex(low, phi);
    ring_vertex(high, phi);
  }
  for (int i = 0; i < sides; ++i) {
    const std::uint32_t a = first + 2 * static_cast<std::uint32_t>(i);
    if (low.x > 0.f) to.triangles.push_back({a, a + 2, high.x > 0.f ? a + 3 : a + 1});
    if (high.x > 0.f) to.triangles.push_back({a, a + 3, a + 1});
  }
}

// Rounded rectangle around the box at height y, counter-clockwise seen from above, drawn in by
// `inset`.
std::vector<Vec3> rounded_outline(const Bounds3f& box, float round, float inset, float y) {
  constexpr int kArc = 3;  // segments of a quarter circle
  constexpr std::array<Vec2, 4> kCorners{Vec2(1, -1), {-1, -1}, {-1, 1}, {1, 1}};
  const Vec3 center = box.center();
  const Vec2 half(0.5f * box.extent().x - round, 0.5f * box.extent().z - round);
  std::vector<Vec3> outline;
  for (int corner = 0; corner < 4; ++corner) {
    for (int i = 0; i <= kArc; ++i) {
      const float phi = 0.5f * kPi * (static_cast<float>(corner) + static_cast<float>(i) / kArc);
      const Vec2 at =
          kCorners[corner] * half + (round - inset) * Vec2(std::cos(phi), -std::sin(phi));
      outline.push_back({center.x + at.x, y, center.z + at.y});
    }
  }
  return outline;
}

}  // namespace

void append_triangle(Primitive& to, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const std::uint32_t first = append_vertex(to, a, normal);
  append_vertex(to, b, normal);
  append_vertex(to, c, normal);
  to.triangles.push_back({first, first + 1, first + 2});
}

void append_quad(Primitive& to, const std::array<Vec3, 4>& corners) {
  const Vec3 normal = glm::normalize(glm::cross(corners[2] - corners[0], corners[3] - corners[1]));
  const std::uint32_t first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3& corner : corners) append_vertex(to, corner, normal);
  to.triangles.push_back({first, first + 1, first + 2});
  to.triangles.push_back({first, first + 2, first + 3});
}

std::array<Vec3, 4> side_of(const Bounds3f& box, Side side, Facing facing) {
  const int axis = static_cast<int>(side) / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool high = static_cast<int>(side) % 2 == 1;
  // Around a high side u then v runs counter-clockwise seen from outside.
  std::array<Vec3, 4> corners;
  constexpr std::array<std::array<bool, 2>, 4> kRound{
      {{false, false}, {true, false}, {true, true}, {false, true}}};
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i][axis] = high ? box.upper[axis] : box.lower[axis];
    corners[i][u] = kRound[i][0] ? box.upper[u] : box.lower[u];
    corners[i][v] = kRound[i][1] ? box.upper[v] : box.lower[v];
  }
  if (high != (facing == Facing::outwards)) std::swap(corners[1], corners[3]);
  return corners;
}

void append_box(Primitive& to, const Bounds3f& box) {
  for (const Side side : kAllSides) append_quad(to, side_of(box, side));
}

void append_revolution(Primitive& to, const Vec3& base, const Vec3& axis,
                       std::span<const Vec2> profile, int sides) {
  const Frame frame = Frame::from_normal(axis);
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    append_band(to, base, frame, profile[i], profile[i + 1], sides);
}

void append_rod(Primitive& to, const Vec3& from, const Vec3& end, float radius, int sides) {
  const float length = glm::length(end - from);
  const std::array<Vec2, 4> profile{Vec2(0.f), {radius, 0.f}, {radius, length}, {0.f, length}};
  append_revolution(to, from, (end - from) / length, profile, sides);
}

void append_vessel(Primitive& to, const Vec3& base, const Vessel& v, int sides) {
  const std::array<Vec2, 6> profile{Vec2(0.f),
                                    {v.bottom_radius, 0.f},
                                    {v.top_radius, v.height},
                                    {v.top_radius - v.wall, v.height},
                                    {v.bottom_radius - v.wall, v.wall},
                                    {0.f, v.wall}};
  append_revolution(to, base, {0.f, 1.f, 0.f}, profile, sides);
}

void append_cushion(Primitive& to, const Bounds3f& box, float round, float bevel) {
  const std::array rings{rounded_outline(box, round, bevel, box.lower.y),
                         rounded_outline(box, round, 0.f, box.lower.y + bevel),
                         rounded_outline(box, round, 0.f, box.upper.y - bevel),
                         rounded_outline(box, round, bevel, box.upper.y)};
  const std::size_t n = rings[0].size();
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t next = (i + 1) % n;
      append_quad(to,
                  {rings[ring][i], rings[ring][next], rings[ring + 1][next], rings[ring + 1][i]});
    }
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    append_triangle(to, rings[3][0], rings[3][i], rings[3][i + 1]);
    append_triangle(to, rings[0][0], rings[0][i + 1], rings[0][i]);
  }
}

void append_moved(Primitive& to, const Primitive& part, const Mat4& transform) {
  const std::uint32_t first = static_cast<std::uint32_t>(to.positions.size());
  const Mat4 for_normals = glm::transpose(glm::inverse(transform));
  for (const Vec3& p : part.positions) to.positions.push_back(transform_point(transform, p));
  for (const Vec3& n : part.normals)
    to.normals.push_back(glm::normalize(transform_vector(for_normals, n)));
  for (const auto& t : part.triangles)
    to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace halflight
