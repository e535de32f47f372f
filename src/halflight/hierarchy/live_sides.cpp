#include "halflight/hierarchy/live_sides.h"

#include <algorithm>
#include <atomic>
#include <span>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::uint32_t kRaysPerBody = 256;
constexpr std::uint32_t kWalks = 64;
// Small things get fewer of both: there are many, and what a mistake could lose is little.
constexpr float kSmallBody = 0.01f;  // of the scene's diagonal
constexpr std::uint32_t kFewerRays = 8, kFewerWalks = 16;
constexpr int kStepsOfWalk = 8;
// Inside a large body, which may be a dark room behind a door left ajar: enough to find openings of
// a few ten-thousandths of its sides.
constexpr float kLargeBody = 0.25f;  // of the scene's diagonal
constexpr std::uint32_t kWalksInLargeBody = 256;
constexpr int kStepsInLargeBody = 64;
constexpr std::size_t kMostConvexFaces = 64;
constexpr float kConvexWithin = 1e-4f;  // of the body's height above a face
constexpr std::uint32_t kRaysPerLargeSide = 64;
constexpr std::uint32_t kRaysPerEmitter = 32;  // of each side of each emitting triangle
constexpr float kLargeSurface = 1e-3f;         // share of the largest surface's area

// What lets light into a closed body, or makes it inside.
struct Openings {
  IdVector<BodyId, std::uint8_t> transparent;  // some material lets light through
  IdVector<BodyId, std::uint8_t> emits_back;   // some double-sided emitter
};

Openings find_openings(const Scene& scene, const Geometry& g, const Bodies& bodies) {
  const std::size_t n = bodies.size();
  Openings openings{IdVector<BodyId, std::uint8_t>(n, 0), IdVector<BodyId, std::uint8_t>(n, 0)};
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t) {
    const Material& m = scene.materials[g.materials[TriangleId(t)]];
    const BodyId id = bodies.of_triangle[TriangleId(t)];
    if (may_be_transparent(m)) openings.transparent[id] = 1;
    if (m.emits() && m.double_sided) openings.emits_back[id] = 1;
  }
  return openings;
}

Vec3 direction_about(const Vec3& n, std::uint32_t i, std::uint64_t seed) {
  return Frame::from_normal(n).to_world(cosine_hemisphere(r2_sequence(i, random_shift(seed))));
}

Bounds3f bounds_of(const Geometry& g, std::span<const TriangleId> triangles) {
  Bounds3f box;
  for (const TriangleId t : triangles)
    for (const Vec3& corner : g.corners(t)) box.extend(corner);
  return box;
}

std::uint32_t scaled_to(float size, const Geometry& g, std::uint32_t trials, std::uint32_t fewer) {
  return size < kSmallBody * g.bounds.diagonal() ? trials / fewer : trials;
}

// This side is the inside of a small convex body, known without a ray. In larger ones there may be
// a lamp that lights them by way of other things.
bool is_inside_of_convex(const Geometry& g, const RayScene& rays, std::span<const TriangleId> body,
                         bool back) {
  if (body.size() > kMostConvexFaces ||
      !(bounds_of(g, body).diagonal() < kSmallBody * g.bounds.diagonal()))
    return false;
  const float flat = 4.f * rays.lift_distance();
  return std::all_of(body.begin(), body.end(), [&](TriangleId face) {
    const Vec3 at = g.corners(face)[0];
    const Vec3 n = glm::normalize(g.scaled_normal(face)) * (back ? -1.f : 1.f);
    float lowest = 0.f, highest = 0.f;
    for (const TriangleId t : body)
      for (const Vec3& p : g.corners(t)) {
        const float height = glm::dot(p - at, n);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
      }
    return highest > flat && lowest > -kConvexWithin * highest;
  });
}

// Every ray that leaves this side of the closed body meets the same side of the same body again.
bool sees_only_itself(const Geometry& g, const RayScene& rays, const Bodies& bodies, BodyId id,
                      bool back) {
  const std::span<const TriangleId> members = bodies.members(id);
  if (is_inside_of_convex(g, rays, members, back)) return true;
  const float size = bounds_of(g, members).diagonal();
  const float reach = size + 4.f * rays.lift_distance();  // beyond it nothing is of this body
  for (std::uint32_t i = 0; i < scaled_to(size, g, kRaysPerBody, kFewerRays); ++i) {
    const std::uint64_t seed = hash(id.value, i, back);
    const TriangleId t = members[seed % members.size()];
    const auto [a, b, c] = g.corners(t);
    const Vec3 n = glm::normalize(g.scaled_normal(t)) * (back ? -1.f : 1.f);
    const Vec3 p = rays.lift((a + b + c) / 3.f, n);
    const auto hit = rays.closest_hit(p, direction_about(n, i, id.value), reach, seed);
    if (!hit || bodies.of_triangle[hit->triangle] != id || hit->front == back) return false;
  }
  return true;
}

// No random walk that starts on this side leaves the bounds of its body: so it is with the insides
// of things that have no bottom and stand on the floor, and of those whose bottom lies in it. The
// front of a large body may be a room to walk through, which is to be seen even where it is dark.
bool is_sealed_off(const Scene& scene, const Geometry& g, const RayScene& rays,
                   const Bodies& bodies, BodyId id, bool back) {
  const std::span<const TriangleId> members = bodies.members(id);
  const Bounds3f box = bounds_of(g, members);
  const bool large = box.diagonal() > kLargeBody * g.bounds.diagonal();
  if (large && !back) return false;
  const int steps = large ? kStepsInLargeBody : kStepsOfWalk;
  const std::uint32_t walks =
      large ? kWalksInLargeBody : scaled_to(box.diagonal(), g, kWalks, kFewerWalks);
  const Vec3 margin(4.f * rays.lift_distance());
  const float reach = box.diagonal() + 4.f * glm::length(margin);  // who gets so far has left it
  for (std::uint32_t i = 0; i < walks; ++i) {
    const TriangleId start = members[hash(id.value, i, back, 1) % members.size()];
    const auto [a, b, c] = g.corners(start);
    Vec3 p = (a + b + c) / 3.f;
    Vec3 n = glm::normalize(g.scaled_normal(start)) * (back ? -1.f : 1.f);
    for (int step = 0; step < steps; ++step) {
      const std::uint64_t seed = hash(id.value, i, back, step + 2);
      const auto hit = rays.closest_hit(rays.lift(p, n), direction_about(n, 0, seed), reach, seed);
      if (!hit || scene.materials[g.materials[hit->triangle]].emits()) return false;
      p = hit_position(g, *hit);
      n = hit_normal(g, *hit);
      if (glm::any(glm::lessThan(p, box.lower - margin)) ||
          glm::any(glm::greaterThan(p, box.upper + margin)))
        return false;
    }
  }
  return true;
}

bool sees_nothing(const Geometry& g, const Surfaces& surfaces, const RayScene& rays, SideId side) {
  const Surface& s = surfaces[side];
  const Vec3 n = surfaces.normal(side);
  for (std::uint32_t i = 0; i < kRaysPerLargeSide; ++i) {
    const std::uint64_t seed = hash(side.value, i);
    const TriangleId t = surfaces.triangles[s.first_triangle + seed % s.triangle_count];
    const Vec3 p = g.point(t, uniform_triangle(random_shift(seed)));
    if (rays.closest_hit(rays.lift(p, n), direction_about(n, i, side.value), kInfinity, seed))
      return false;
  }
  return true;
}

// Rays of receivers may all miss a small lamp: its own rays find whom it lights. `visit` is called
// once for every side met, and may be called for the same side by several threads.
template <class Visit>
void follow_emission(const Scene& scene, const Geometry& g, const Surfaces& surfaces,
                     const RayScene& rays, const Visit& visit) {
  parallel_for(g.triangles.size(), 64, [&](std::size_t i) {
    const TriangleId t(i);
    const Material& m = scene.materials[g.materials[t]];
    if (!m.emits()) return;
    for (const bool back : {false, true}) {
      if (back && !m.double_sided) continue;
      const Vec3 n = glm::normalize(g.scaled_normal(t)) * (back ? -1.f : 1.f);
      for (std::uint32_t k = 0; k < kRaysPerEmitter; ++k) {
        const std::uint64_t seed = hash(i, k, back);
        const Vec3 p = g.point(t, uniform_triangle(random_shift(seed)));
        const auto hit =
            rays.closest_hit(rays.lift(p, n), direction_about(n, k, hash(i)), kInfinity, seed);
        if (hit) visit(surfaces.side_hit(*hit));
      }
    }
  });
}

// Sides that light from an emitter was seen to reach, and so the sides of bodies.
struct LitByEmission {
  std::vector<std::atomic<std::uint8_t>> sides, bodies;  // bodies: front and back of each
};

LitByEmission find_lit_by_emission(const Scene& scene, const Geometry& g, const Surfaces& surfaces,
                                   const RayScene& rays, const Bodies& bodies) {
  LitByEmission lit{std::vector<std::atomic<std::uint8_t>>(2 * surfaces.surfaces.size()),
                    std::vector<std::atomic<std::uint8_t>>(2 * bodies.size())};
  follow_emission(scene, g, surfaces, rays, [&](SideId side) {
    const TriangleId t = surfaces.triangles[surfaces[side].first_triangle];
    lit.sides[side.value].store(1, std::memory_order_relaxed);
    lit.bodies[2 * bodies.of_triangle[t].value + (is_back(side) ? 1 : 0)].store(
        1, std::memory_order_relaxed);
  });
  return lit;
}

}  // namespace

IdVector<SideId, std::uint8_t> find_live_sides(const Scene& scene, const Geometry& g,
                                               const Surfaces& surfaces, const RayScene& rays) {
  const Bodies& bodies = surfaces.bodies;
  const Openings openings = find_openings(scene, g, bodies);
  const LitByEmission lit = find_lit_by_emission(scene, g, surfaces, rays, bodies);
  std::vector<std::uint8_t> dead(2 * bodies.size(), 0);
  parallel_for(dead.size(), 64, [&](std::size_t i) {
    const BodyId id(i / 2);
    const bool back = i % 2 != 0;
    if (openings.transparent[id] || lit.bodies[i]) return;
    const bool lit_by_itself =
        std::any_of(bodies.members(id).begin(), bodies.members(id).end(),
                    [&](TriangleId t) { return scene.materials[g.materials[t]].emits(); }) &&
        (!back || openings.emits_back[id]);
    if (lit_by_itself) return;
    for (const PunctualLight& light : g.lights)
      if (light.kind != Light::Kind::directional) return;
    dead[i] = (bodies.closed[id] && sees_only_itself(g, rays, bodies, id, back)) ||
              is_sealed_off(scene, g, rays, bodies, id, back);
  });

  const bool lit_from_outside = max_component(scene.sky) > 0.f || !g.lights.empty();
  float largest = 0.f;
  for (const Surface& s : surfaces.surfaces) largest = std::max(largest, s.area);
  IdVector<SideId, std::uint8_t> live(2 * surfaces.surfaces.size(), 1);
  parallel_for(live.size(), 64, [&](std::size_t i) {
    const SideId side(i);
    const Surface& s = surfaces[side];
    const TriangleId t = surfaces.triangles[s.first_triangle];
    const BodyId body = bodies.of_triangle[t];
    const Material& m = scene.materials[s.material];
    if (lit.sides[i] || (m.emits() && (!is_back(side) || m.double_sided))) return;
    if (dead[2 * body.value + (is_back(side) ? 1 : 0)])
      live[side] = 0;
    else if (!lit_from_outside && s.area > kLargeSurface * largest)
      live[side] = !sees_nothing(g, surfaces, rays, side);
  });
  return live;
}

}  // namespace halflight
