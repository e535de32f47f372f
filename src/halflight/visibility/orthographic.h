// Drawing convex polygons in an orthographic picture of a box.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "halflight/base/vec.h"

namespace halflight {

inline Vec3 corner_of(const Bounds3f& box, int i) {
  return {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
          i & 4 ? box.upper.z : box.lower.z};
}

// Places a direction's picture over the projection of a box.
struct Easel {
  Frame frame;  // its normal points along the direction
  Vec2 lower{0.f};
  float pixel = 0.f;  // metres
  int width = 1, height = 1;

  // `resolution` pixels along the longer side. `turn`, in radians about the direction, keeps edges
  // that run along the axes from falling between two rows as a whole.
  Easel(const Bounds3f& box, const Vec3& direction, int resolution, float turn = 0.f)
      : frame(Frame::from_normal(glm::normalize(direction))) {
    if (turn != 0.f) {
      const float c = std::cos(turn), s = std::sin(turn);
      frame = {c * frame.tangent + s * frame.bitangent, c * frame.bitangent - s * frame.tangent,
               frame.normal};
    }
    Vec2 upper(-kInfinity);
    lower = Vec2(kInfinity);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec2 p = flat(corner_of(box, corner));
      lower = glm::min(lower, p);
      upper = glm::max(upper, p);
    }
    const Vec2 extent = upper - lower;
    pixel = std::max(std::max(extent.x, extent.y), 1e-20f) / static_cast<float>(resolution);
    width = std::clamp(static_cast<int>(std::ceil(extent.x / pixel)), 1, resolution);
    height = std::clamp(static_cast<int>(std::ceil(extent.y / pixel)), 1, resolution);
  }

  Vec2 flat(const Vec3& p) const {
    return {glm::dot(p, frame.tangent), glm::dot(p, frame.bitangent)};
  }
  Vec2 to_pixels(const Vec3& p) const { return (flat(p) - lower) / pixel; }
  // A point of the line through the centre of a pixel.
  Vec3 from_pixel(int x, int y) const {
    const Vec2 p = lower + pixel * Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    return p.x * frame.tangent + p.y * frame.bitangent;
  }
};

struct PictureEdge {
  Vec2 from{0.f}, to{0.f};  // pixels
  float slope = 0.f;

  PictureEdge() = default;
  PictureEdge(Vec2 a, Vec2 b) : from(a), to(b), slope((b.x - a.x) / (b.y - a.y)) {}
  bool crosses(float y) const { return (from.y <= y) != (to.y <= y); }
  float x_at(float y) const { return from.x + (y - from.y) * slope; }
};

// Calls draw(y, first x, last x) for the pixels whose centres lie in the convex hull of the edges.
template <class Draw>
void for_each_row(const Easel& easel, std::span<const PictureEdge> edges, const Draw& draw) {
  float lower = kInfinity, upper = -kInfinity;
  for (const PictureEdge& e : edges) {
    lower = std::min({lower, e.from.y, e.to.y});
    upper = std::max({upper, e.from.y, e.to.y});
  }
  const int y0 = std::max(0, static_cast<int>(std::ceil(lower - 0.5f)));
  const int y1 = std::min(easel.height - 1, static_cast<int>(std::floor(upper - 0.5f)));
  for (int y = y0; y <= y1; ++y) {
    const float at = static_cast<float>(y) + 0.5f;
    float left = kInfinity, right = -kInfinity;
    for (const PictureEdge& e : edges) {
      if (!e.crosses(at)) continue;
      left = std::min(left, e.x_at(at));
      right = std::max(right, e.x_at(at));
    }
    if (!(left <= right)) continue;
    const int x0 = std::max(0, static_cast<int>(std::ceil(left - 0.5f)));
    const int x1 = std::min(easel.width - 1, static_cast<int>(std::floor(right - 0.5f)));
    if (x0 <= x1) draw(y, x0, x1);
  }
}

}  // namespace halflight
