#include "halflight/transport/form_factor.h"

#include <array>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace halflight {
namespace {

// In double precision: what edges contribute cancels to a part in size^2 / distance^2 of itself.
using Corner = glm::dvec3;

// The corners above the horizon, relative to x; a convex polygon gains at most one corner.
std::size_t clip_to_horizon(const Corner& x, const Corner& n, std::span<const Vec3> polygon,
                            std::span<Corner> clipped) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner a = Corner(polygon[i]) - x, b = Corner(polygon[(i + 1) % polygon.size()]) - x;
    const double da = glm::dot(a, n), db = glm::dot(b, n);
    if (da >= 0.0 && count < clipped.size()) clipped[count++] = a;
    if (((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) && count < clipped.size())
      clipped[count++] = a + (b - a) * (da / (da - db));
  }
  return count;
}

}  // namespace

float polygon_form_factor(const Vec3& x, const Vec3& n, std::span<const Vec3> polygon) {
  std::array<Corner, 20> corner;
  const Corner normal(n);
  const std::size_t count = clip_to_horizon(Corner(x), normal, polygon, corner);
  if (count < 3) return 0.f;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner &a = corner[i], &b = corner[(i + 1) % count];
    const Corner cross = glm::cross(a, b);
    const double sine = glm::length(cross);
    if (!(sine > 0.0)) continue;
    sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(cross, normal) / sine;
  }
  return std::min(1.f, static_cast<float>(std::abs(sum) / (2.0 * glm::pi<double>())));
}

}  // namespace halflight
