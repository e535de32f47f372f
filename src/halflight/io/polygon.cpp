// Ear clipping (Meisters 1975; O'Rourke, Computational Geometry in C, 1.4): an ear is a convex
// corner whose triangle holds no other corner; cutting one leaves a smaller polygon. Of the ears
// the best shaped is cut first. O(n^2) time, and O(n) per corner to find the reflex corners inside:
// no other lies there alone, unless the polygon crosses itself.
#include "halflight/io/polygon.h"

#include <glm/geometric.hpp>

namespace halflight {
namespace {

using DVec2 = glm::dvec2;

// Above this, a polygon is cut as a fan from its first corner: quadratic time would let a small
// file keep the reader busy for hours, and no modeller writes such faces.
constexpr std::size_t kMaxEarClipped = 4096;
// Up to this, what is quadratic does not count.
constexpr std::size_t kFewCorners = 64;

// Twice the signed area of a triangle.
double cross(DVec2 a, DVec2 b, DVec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon seen along its Newell normal, so that it runs counter-clockwise.
std::vector<DVec2> flattened(std::span<const Vec3> corners) {
  glm::dvec3 normal(0.0);
  const glm::dvec3 origin(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - origin;
    const glm::dvec3 b = glm::dvec3(corners[(i + 1) % corners.size()]) - origin;
    normal += glm::cross(a, b);
  }
  // Dropping the axis closest to the normal keeps the shape simple when it was.
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<DVec2> flat(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 p = glm::dvec3(corners[i]) - origin;
    flat[i] = {sign * p[u], p[v]};
  }
  return flat;
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<DVec2> points)
      : points_(std::move(points)),
        next_(points_.size()),
        previous_(points_.size()),
        quality_(points_.size()),
        remaining_(points_.size()) {
    const auto n = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (!(corner_area(i) > 0.0)) reflex_.push_back(i);
    for (std::uint32_t i = 0; i < n; ++i) quality_[i] = ear_quality(i);
  }

  // One triangle per call, until two corners are left.
  std::array<std::uint32_t, 3> clip() {
    std::uint32_t best = start_;
    for (std::uint32_t i = next_[start_]; i != start_; i = next_[i])
      if (quality_[i] > quality_[best]) best = i;
    const std::uint32_t before = previous_[best], after = next_[best];
    next_[before] = after;
    previous_[after] = before;
    std::erase(reflex_, best);
    start_ = before;
    if (--remaining_ > 2) {
      quality_[before] = ear_quality(before);
      quality_[after] = ear_quality(after);
    }
    return {before, best, after};
  }

 private:
  static constexpr double kNoEar = -1.0;

  double corner_area(std::uint32_t i) const {
    return cross(points_[previous_[i]], points_[i], points_[next_[i]]);
  }

  // Area over squared longest side; kNoEar when the corner is no ear.
  double ear_quality(std::uint32_t i) const {
    const DVec2 a = points_[previous_[i]], b = points_[i], c = points_[next_[i]];
    const double area = corner_area(i);
    if (!(area > 0.0)) return kNoEar;
    for (const std::uint32_t k : reflex_) {
      const DVec2 p = points_[k];
      if (p == a || p == b || p == c) continue;
      if (cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0) return kNoEar;
    }
    const auto squared = [](DVec2 d) { return glm::dot(d, d); };
    return area / std::max({squared(b - a), squared(c - b), squared(a - c)});
  }

  std::vector<DVec2> points_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint32_t> reflex_;  // or straight, when all corners were there
  std::vector<double> quality_;
  std::size_t remaining_;
  std::uint32_t start_ = 0;
};

// A convex quad is cut from its first corner, as most programs do: when it is bent, the diagonal
// decides where its surface lies.
bool fan_covers_quad(std::span<const Vec3> corners) {
  const std::vector<DVec2> p = flattened(corners);
  return cross(p[0], p[1], p[2]) > 0.0 && cross(p[0], p[2], p[3]) > 0.0;
}

}  // namespace

std::size_t cutting_effort(std::size_t corners) {
  return corners <= kFewCorners || corners > kMaxEarClipped ? 0 : corners * corners;
}

void triangulate_polygon(std::span<const Vec3> corners,
                         std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::size_t n = corners.size();
  if (n < 3) return;
  if (n == 3 || n > kMaxEarClipped || (n == 4 && fan_covers_quad(corners))) {
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    return;
  }
  EarClipper clipper(flattened(corners));
  for (std::size_t i = 0; i + 2 < n; ++i) triangles.push_back(clipper.clip());
}

}  // namespace halflight
