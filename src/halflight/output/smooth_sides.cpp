#include "halflight/output/smooth_sides.h"

#include <algorithm>
#include <cmath>

namespace halflight {
namespace {

constexpr float kCosCrease = 0.866f;        // 30 degrees between faces without normals: rounded
constexpr float kCosSameNormal = 0.985f;    // 10 degrees between given normals: the same surface
constexpr float kCosGivenNormal = 0.7071f;  // a given normal further off its face is not believed

}  // namespace

FaceCorner measure_corner(const Geometry& g, TriangleFace f, std::size_t k) {
  const auto p = g.corners(f.triangle);
  const std::size_t at = source_corner(f.back, k);
  const float side = f.back ? -1.f : 1.f;
  const Vec3 face = side * glm::normalize(g.scaled_normal(f.triangle));
  const Vec3 to_next = glm::normalize(p[(at + 1) % 3] - p[at]);
  const Vec3 to_last = glm::normalize(p[(at + 2) % 3] - p[at]);
  const Vec3 given = side * g.normal(g.triangles[f.triangle][at]);
  FaceCorner c;
  c.given = glm::dot(given, face) > kCosGivenNormal;
  c.normal = c.given ? given : face;
  c.angle = std::acos(std::clamp(glm::dot(to_next, to_last), -1.f, 1.f));
  c.inwards = glm::normalize(to_next * glm::distance(p[(at + 1) % 3], p[at]) +
                             to_last * glm::distance(p[(at + 2) % 3], p[at]));
  return c;
}

bool continues(const FaceCorner& a, const FaceCorner& b) {
  return glm::dot(a.normal, b.normal) > (a.given || b.given ? kCosSameNormal : kCosCrease);
}

}  // namespace halflight
