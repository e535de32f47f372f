#include "halflight/rays/automatic_view.h"

#include <algorithm>
#include <vector>

#include "halflight/base/parallel.h"
#include "halflight/rays/camera_rays.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::size_t kEyes = 256;
constexpr int kDirections = 8;
constexpr int kRaysPerSide = 10;      // of the square grid that judges a view
constexpr float kPitch = -0.1f;       // radians: a little downwards
constexpr float kFieldOfView = 0.9f;  // radians
constexpr float kLampShare = 0.25f;   // what seeing a light is worth against seeing a lit surface

struct Eye {
  Vec3 position{0.f};
  float room = 0.f;  // free distance before the surface, metres
};

// Half way through the open space before a random point of a random triangle.
Eye eye_before_surface(const PathTracer& tracer, std::uint64_t seed) {
  const Geometry& g = tracer.world().geometry;
  const TriangleId t(hash(seed, 1) % g.triangles.size());
  RayHit start{t, uniform_triangle(random_shift(seed)), 0.f, (hash(seed, 2) & 1u) == 0};
  const SurfacePoint from = surface_point(g, start);
  const Vec3 origin = tracer.world().rays.lift(from.position, from.normal);
  const float farthest = g.bounds.diagonal();
  const auto hit = tracer.world().rays.closest_hit(origin, from.normal, farthest, seed);
  const float room = hit ? hit->distance : farthest;
  return {origin + 0.5f * room * from.normal, room};
}

PlacedCamera look(const Vec3& position, int direction) {
  const float azimuth = 2.f * kPi * static_cast<float>(direction) / kDirections;
  PlacedCamera camera;
  camera.position = position;
  camera.forward = Vec3(std::cos(kPitch) * std::sin(azimuth), std::sin(kPitch),
                        -std::cos(kPitch) * std::cos(azimuth));
  camera.vertical_fov = kFieldOfView;
  return camera;
}

// (different triangles + all) x (lit surfaces, near ones counting less than far ones).
float judge(const PathTracer& tracer, const PlacedCamera& camera, float comfortable_distance,
            std::uint64_t seed) {
  const CameraRays pixels(camera, kRaysPerSide, kRaysPerSide);
  std::vector<TriangleId> seen;
  float worth = 0.f;
  for (int i = 0; i < kRaysPerSide * kRaysPerSide; ++i) {
    const CameraRay ray = pixels.through(Vec2(i % kRaysPerSide, i / kRaysPerSide) + 0.5f);
    const auto hit =
        tracer.world().rays.closest_hit(ray.origin, ray.direction, kInfinity, hash(seed, i));
    if (!hit) continue;
    const bool is_lamp = max_component(tracer.emitters().radiance(hit->triangle, hit->barycentric,
                                                                  hit->front)) > 0.f;
    PathSampler sampler(seed, static_cast<std::uint32_t>(i));
    const Rgb arriving = tracer.radiance(ray.origin, ray.direction, sampler);
    if (!(max_component(arriving) > 0.f)) continue;
    if (!is_lamp) seen.push_back(hit->triangle);
    worth += (is_lamp ? kLampShare : 1.f) * hit->distance / (hit->distance + comfortable_distance);
  }
  std::sort(seen.begin(), seen.end());
  const auto different = std::unique(seen.begin(), seen.end()) - seen.begin();
  return worth * (static_cast<float>(different) + kRaysPerSide * kRaysPerSide);
}

}  // namespace

PlacedCamera automatic_view(const PathTracer& tracer, std::uint64_t seed) {
  if (tracer.world().geometry.triangles.empty()) return {};
  std::vector<Eye> eyes(kEyes);
  parallel_for(kEyes, 8,
               [&](std::size_t i) { eyes[i] = eye_before_surface(tracer, hash(seed, i)); });
  std::vector<float> rooms;
  for (const Eye& eye : eyes) rooms.push_back(eye.room);
  std::nth_element(rooms.begin(), rooms.begin() + kEyes / 2, rooms.end());
  const float comfortable_distance = 0.5f * rooms[kEyes / 2];

  std::vector<float> scores(kEyes * kDirections);
  parallel_for(scores.size(), 8, [&](std::size_t i) {
    const PlacedCamera camera =
        look(eyes[i / kDirections].position, static_cast<int>(i % kDirections));
    scores[i] = judge(tracer, camera, comfortable_distance, hash(seed, kEyes + i));
  });
  const auto best =
      static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
  return look(eyes[best / kDirections].position, static_cast<int>(best % kDirections));
}

}  // namespace halflight
