#include "halflight/transport/form_factor.h"

#include <array>

namespace halflight {
namespace {

// The corners above the horizon, relative to x; a convex polygon gains at most one corner.
std::size_t clip_to_horizon(const Vec3& x, const Vec3& n, std::span<const Vec3> polygon,
                            std::span<Vec3> clipped) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = polygon[i] - x, b = polygon[(i + 1) % polygon.size()] - x;
    const float da = glm::dot(a, n), db = glm::dot(b, n);
    if (da >= 0.f && count < clipped.size()) clipped[count++] = a;
    if (((da > 0.f && db < 0.f) || (da < 0.f && db > 0.f)) && count < clipped.size())
      clipped[count++] = a + (b - a) * (da / (da - db));
  }
  return count;
}

}  // namespace

float polygon_form_factor(const Vec3& x, const Vec3& n, std::span<const Vec3> polygon) {
  std::array<Vec3, 20> corner;
  const std::size_t count = clip_to_horizon(x, n, polygon, corner);
  if (count < 3) return 0.f;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &a = corner[i], &b = corner[(i + 1) % count];
    const Vec3 cross = glm::cross(a, b);
    const float sine = glm::length(cross);
    if (!(sine > 0.f)) continue;
    const float angle = std::atan2(sine, glm::dot(a, b));
    sum += static_cast<double>(angle * glm::dot(cross, n) / sine);
  }
  return std::min(1.f, static_cast<float>(std::abs(sum)) / (2.f * kPi));
}

}  // namespace halflight
