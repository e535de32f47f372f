#include "halflight/rays/sensor_placement.h"

#include <algorithm>

namespace halflight {
namespace {

constexpr float kReachShare = 1e-4f;  // of the scene's diagonal
constexpr float kReachLifts = 8.f;    // rounding errors
constexpr float kLeastCosine = 0.5f;  // 60 degrees
constexpr float kOneSheet = 4.f;      // lifts: layers that are closer together are one
constexpr float kSameLean = 0.1f;     // cosines that differ by less are equal
constexpr float kSameHeight = 0.25f;  // lifts: heights that differ by less are equal

// Share of the segment from `start` along `edge` at which it is closest to p, within [0, 1].
float along(const Vec3& p, const Vec3& start, const Vec3& edge) {
  const float length_squared = glm::dot(edge, edge);
  if (!(length_squared > 0.f)) return 0.f;
  return std::clamp(glm::dot(p - start, edge) / length_squared, 0.f, 1.f);
}

struct Candidate {
  SensorPlacement placement;
  float distance = kInfinity;
  float height = 0.f;  // above the sensor along its normal
  float cosine = 0.f;
};

Candidate candidate(const Geometry& g, TriangleId t, const Vec3& p, const Vec3& n) {
  const auto [a, b, c] = g.corners(t);
  const Vec3 normal = glm::normalize(g.scaled_normal(t));
  Candidate found;
  SensorPlacement& at = found.placement;
  at.triangle = t;
  at.barycentric = closest_barycentric(p, a, b, c);
  at.position = g.point(t, at.barycentric);
  const float cosine = glm::dot(normal, n);
  at.front = cosine >= 0.f;
  at.normal = at.front ? normal : -normal;
  found.distance = glm::distance(p, at.position);
  found.height = glm::dot(at.position - p, n);
  found.cosine = std::abs(cosine);
  return found;
}

}  // namespace

// The foot of the perpendicular when it is inside, else the nearest point of the three edges.
Vec2 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 normal = glm::cross(ab, ac);
  const float inverse = 1.f / glm::dot(normal, normal);
  const Vec2 foot(glm::dot(glm::cross(ap, ac), normal) * inverse,
                  glm::dot(glm::cross(ab, ap), normal) * inverse);
  if (foot.x >= 0.f && foot.y >= 0.f && foot.x + foot.y <= 1.f) return foot;

  const float on_ab = along(p, a, ab), on_ac = along(p, a, ac), on_bc = along(p, b, c - b);
  const std::array<Vec2, 3> edges{Vec2(on_ab, 0.f), Vec2(0.f, on_ac), Vec2(1.f - on_bc, on_bc)};
  const auto distance = [&](Vec2 w) { return glm::length(w.x * ab + w.y * ac - ap); };
  return *std::min_element(edges.begin(), edges.end(),
                           [&](Vec2 l, Vec2 r) { return distance(l) < distance(r); });
}

float sensor_reach(const Geometry& geometry, const RayScene& rays) {
  return std::max(kReachShare * geometry.bounds.diagonal(), kReachLifts * rays.lift_distance());
}

SensorPlacement place_sensor(const Geometry& geometry, const RayScene& rays, const Vec3& position,
                             const Vec3& normal) {
  SensorPlacement in_the_air;
  in_the_air.position = position;
  in_the_air.normal = normal;
  if (geometry.triangles.empty()) return in_the_air;

  const float reach = sensor_reach(geometry, rays);
  std::vector<Candidate> candidates;
  for (const TriangleId t : rays.triangles_near(position, reach)) {
    const Candidate c = candidate(geometry, t, position, normal);
    if (c.distance <= reach && c.cosine >= kLeastCosine) candidates.push_back(c);
  }
  if (candidates.empty()) return in_the_air;
  const float lift = rays.lift_distance();
  const auto keep_most = [&](auto value, float tolerance) {
    float most = -kInfinity;
    for (const Candidate& c : candidates) most = std::max(most, value(c));
    std::erase_if(candidates, [&](const Candidate& c) { return value(c) < most - tolerance; });
  };
  keep_most([](const Candidate& c) { return -c.distance; }, kOneSheet * lift);
  keep_most([](const Candidate& c) { return c.cosine; }, kSameLean);
  keep_most([](const Candidate& c) { return c.height; }, kSameHeight * lift);
  keep_most([](const Candidate& c) { return -c.distance; }, 0.f);
  return candidates.front().placement;
}

}  // namespace halflight
