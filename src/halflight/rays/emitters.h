// All lights of a scene as something that direct light can be sampled from: emitting triangles,
// point and spot lights through a light tree; directional lights one by one. Not the sky, which
// is best found by cosine-distributed rays.
#pragma once

#include <optional>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"
#include "halflight/rays/light_tree.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// One sampled place on a light, seen from a surface.
struct LightSample {
  Vec3 point{0.f};      // on the light
  Vec3 normal{0.f};     // of the light's side that shines at the surface; zero: a punctual light
  Rgb irradiance{0.f};  // W/m2 on the surface when nothing is between, divided by the probability
  TriangleId triangle;  // invalid: a punctual light
  float density = 0.f;  // per steradian; 0: a punctual light, which no ray meets by chance
};

class Emitters {
 public:
  // Refers to scene and geometry: they must outlive it.
  Emitters(const Scene& scene, const Geometry& geometry);

  // On the surface side at p that the unit normal n points to; u in [0,1)^3. The expected value of
  // `irradiance` is the unoccluded direct light, directional lights and sky apart. May be empty.
  std::optional<LightSample> sample(const Vec3& p, const Vec3& n, float u_light, Vec2 u) const;
  // The density, per steradian, with which `sample` finds a point of this triangle that lies
  // `offset` away from p.
  float density(TriangleId triangle, const Vec3& p, const Vec3& n, const Vec3& offset) const;

  // Radiance that leaves this point of a triangle on its front or back side.
  Rgb radiance(TriangleId triangle, Vec2 barycentric, bool front) const;

  const std::vector<PunctualLight>& directional() const { return directional_; }
  std::size_t size() const { return places_.size() + directional_.size(); }

 private:
  struct Place {
    TriangleId triangle;  // invalid: a punctual light
    std::uint32_t punctual = 0;
  };
  LightBounds bounds_of(TriangleId triangle) const;
  std::optional<LightSample> sample_triangle(TriangleId, const Vec3& p, const Vec3& n, Vec2 u,
                                             float probability) const;

  const Scene* scene_;
  const Geometry* geometry_;
  IdVector<EmitterId, Place> places_;
  IdVector<TriangleId, EmitterId> of_triangle_;  // empty when no triangle emits
  std::vector<PunctualLight> directional_;
  LightTree tree_;
};

}  // namespace halflight
