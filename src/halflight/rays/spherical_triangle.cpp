#include "halflight/rays/spherical_triangle.h"

namespace halflight {
namespace {

// Part of v perpendicular to the unit vector, made unit.
Vec3 perpendicular_part(const Vec3& v, const Vec3& unit) {
  const Vec3 part = v - glm::dot(v, unit) * unit;
  const float length = glm::length(part);
  return length > 0.f ? part / length : Vec3(0.f);
}

float sine_of(float cosine) { return std::sqrt(std::max(0.f, 1.f - cosine * cosine)); }

// Inverse of the distribution with density proportional to (1 - x) a + x b.
float sample_linear(float u, float a, float b) {
  return u * (a + b) / (a + std::sqrt(std::max(0.f, a * a + u * (b * b - a * a))));
}

}  // namespace

SphericalTriangle::SphericalTriangle(const std::array<Vec3, 3>& corners)
    : corners_{glm::normalize(corners[0]), glm::normalize(corners[1]), glm::normalize(corners[2])} {
  const auto& [a, b, c] = corners_;
  const Vec3 ab = glm::cross(a, b), bc = glm::cross(b, c), ca = glm::cross(c, a);
  const float lab = glm::length(ab), lbc = glm::length(bc), lca = glm::length(ca);
  if (!(lab > 0.f) || !(lbc > 0.f) || !(lca > 0.f)) return;
  // Oosterom and Strackee 1983: stable where the sum of angles less pi is not.
  const float volume = std::abs(glm::dot(a, bc));
  solid_angle_ = 2.f * std::atan2(volume, 1.f + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  cos_first_ = glm::clamp(-glm::dot(ca, ab) / (lca * lab), -1.f, 1.f);
  sin_first_ = sine_of(cos_first_);
  if (!(sin_first_ > 0.f)) solid_angle_ = 0.f;
  first_ = std::acos(cos_first_);
  cos_side_ = glm::dot(a, b);
  towards_third_ = perpendicular_part(c, a);
}

Vec3 SphericalTriangle::direction(Vec2 u) const {
  const auto& [a, b, c] = corners_;
  // The third corner slides along its side until the triangle covers the share u.x.
  const float phi = u.x * solid_angle_ - first_;
  const float s = std::sin(phi), t = std::cos(phi);
  const float p = t - cos_first_, q = s + sin_first_ * cos_side_;
  const float divisor = (q * s + p * t) * sin_first_;
  const float cos_slid =
      divisor != 0.f ? glm::clamp(((q * t - p * s) * cos_first_ - q) / divisor, -1.f, 1.f) : 1.f;
  const Vec3 slid = cos_slid * a + sine_of(cos_slid) * towards_third_;
  const float height = 1.f - u.y * (1.f - glm::dot(slid, b));
  return height * b + sine_of(height) * perpendicular_part(slid, b);
}

WarpedPoint sample_bilinear(Vec2 u, const std::array<float, 4>& w) {
  WarpedPoint point;
  point.u.y = sample_linear(u.y, w[0] + w[1], w[2] + w[3]);
  point.u.x = sample_linear(u.x, glm::mix(w[0], w[2], point.u.y), glm::mix(w[1], w[3], point.u.y));
  const float interpolated =
      glm::mix(glm::mix(w[0], w[1], point.u.x), glm::mix(w[2], w[3], point.u.x), point.u.y);
  point.density = 4.f * interpolated / (w[0] + w[1] + w[2] + w[3]);
  return point;
}

}  // namespace halflight
