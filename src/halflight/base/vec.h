// Vectors, colours and boxes. Lengths are metres, colours are linear RGB.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

namespace halflight {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat4 = glm::dmat4;  // transforms are composed in double, applied to float positions
using Rgb = glm::vec3;    // linear, Rec. 709 primaries, unbounded

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Rec. 709 luminance.
inline float luminance(const Rgb& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }
inline float average(const Rgb& c) { return (c.r + c.g + c.b) / 3.f; }
inline float max_component(const Vec3& v) { return std::max({v.x, v.y, v.z}); }
inline float min_component(const Vec3& v) { return std::min({v.x, v.y, v.z}); }
inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Axis-aligned box. The default box is empty: it contains nothing and extends to anything.
struct Bounds3f {
  Vec3 lower{kInfinity};
  Vec3 upper{-kInfinity};

  void extend(const Vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  void extend(const Bounds3f& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }
  bool empty() const { return lower.x > upper.x; }
  Vec3 center() const { return 0.5f * (lower + upper); }
  Vec3 extent() const { return empty() ? Vec3(0.f) : upper - lower; }
  float diagonal() const { return glm::length(extent()); }
  float farthest() const { return max_component(glm::max(glm::abs(lower), glm::abs(upper))); }
  float longest_side() const { return max_component(extent()); }
  int longest_axis() const {
    const Vec3 e = extent();
    if (e.x >= e.y && e.x >= e.z) return 0;
    return e.y >= e.z ? 1 : 2;
  }
  float middle_side() const {
    const Vec3 e = extent();
    return std::max(std::min(e.x, e.y), std::min(std::max(e.x, e.y), e.z));
  }
  float volume() const {
    const Vec3 e = extent();
    return e.x * e.y * e.z;
  }
  float surface_area() const {
    const Vec3 e = extent();
    return 2.f * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  bool contains(const Vec3& p) const {
    return glm::all(glm::lessThanEqual(lower, p)) && glm::all(glm::lessThanEqual(p, upper));
  }
  bool overlaps(const Bounds3f& b) const {
    return glm::all(glm::lessThanEqual(lower, b.upper)) &&
           glm::all(glm::lessThanEqual(b.lower, upper));
  }
};

// Right-handed orthonormal frame whose third axis is a given unit normal.
// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
struct Frame {
  Vec3 tangent, bitangent, normal;

  static Frame from_normal(const Vec3& n) {
    const float sign = std::copysign(1.f, n.z);
    const float a = -1.f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {
        {1.f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }
  Vec3 to_world(const Vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

inline Vec3 transform_point(const Mat4& m, const Vec3& p) {
  return Vec3(m * glm::dvec4(p.x, p.y, p.z, 1.0));
}
inline Vec3 transform_vector(const Mat4& m, const Vec3& v) {
  return Vec3(m * glm::dvec4(v.x, v.y, v.z, 0.0));
}

}  // namespace halflight
