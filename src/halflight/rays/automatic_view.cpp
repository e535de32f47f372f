#include "halflight/rays/automatic_view.h"

#include <algorithm>
#include <vector>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::size_t kPoints = 512;
constexpr int kDirections = 16;
constexpr float kPitch = -0.15f;      // radians: a little downwards
constexpr float kFieldOfView = 0.8f;  // radians
constexpr float kPicture = 0.9f;      // share of the picture's half width that counts as inside
constexpr float kTooNear = 0.2f;  // of the median free distance: things that would fill the view
constexpr std::uint32_t kLightSamples = 8;

struct Place {
  SurfacePoint surface;
  Vec3 eye{0.f};     // in the open space before the surface
  float room = 0.f;  // free distance before the surface, metres
  bool is_lit = false;
};

Place random_place(const PathTracer& tracer, std::uint64_t seed) {
  const auto& [scene, geometry, rays] = tracer.world();
  const TriangleId t(hash(seed, 1) % geometry.triangles.size());
  const RayHit hit{t, uniform_triangle(random_shift(seed)), 0.f, (hash(seed, 2) & 1u) == 0};
  Place place;
  place.surface = surface_point(geometry, hit);
  const Vec3 origin = rays.lift(place.surface.position, place.surface.normal);
  const float farthest = geometry.bounds.diagonal();
  const auto opposite = rays.closest_hit(origin, place.surface.normal, farthest, seed);
  place.room = opposite ? opposite->distance : farthest;
  const float share = 0.3f + 0.65f * to_unit_float(hash(seed, 3));
  place.eye = origin + share * place.room * place.surface.normal;
  // Lamps and sky domes are seen anyway: they are not what a view is taken for.
  if (scene.materials[geometry.materials[t]].emits()) return place;
  const IrradianceEstimate e =
      tracer.estimate_irradiance(place.surface.position, place.surface.normal, kLightSamples, seed);
  place.is_lit = max_component(e.mean) > 0.f;
  return place;
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

bool is_in_picture(const PlacedCamera& camera, const Vec3& point) {
  const Vec3 offset = point - camera.position;
  const Vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const float depth = glm::dot(offset, camera.forward);
  const float reach = kPicture * std::tan(0.5f * camera.vertical_fov) * depth;
  return depth > 0.f && std::abs(glm::dot(offset, right)) < reach &&
         std::abs(glm::dot(offset, glm::cross(right, camera.forward))) < reach;
}

struct Choice {
  PlacedCamera camera;
  int points_shown = -1;
};

Choice best_direction(const RayScene& rays, const std::vector<Place>& places, const Vec3& eye,
                      float least_distance) {
  std::vector<Vec3> visible;
  for (const Place& place : places) {
    const auto& [position, normal] = place.surface;
    if (!place.is_lit || glm::dot(normal, eye - position) <= 0.f) continue;
    if (glm::distance(eye, position) < least_distance) continue;
    if (rays.transmittance(eye, rays.lift(position, normal)) > 0.5f) visible.push_back(position);
  }
  Choice best;
  for (int direction = 0; direction < kDirections; ++direction) {
    const PlacedCamera camera = look(eye, direction);
    const auto shown = std::count_if(visible.begin(), visible.end(), [&](const Vec3& point) {
      return is_in_picture(camera, point);
    });
    if (shown > best.points_shown) best = {camera, static_cast<int>(shown)};
  }
  return best;
}

}  // namespace

PlacedCamera automatic_view(const PathTracer& tracer, std::uint64_t seed) {
  if (tracer.world().geometry.triangles.empty()) return {};
  std::vector<Place> places(kPoints);
  parallel_for(kPoints, 8, [&](std::size_t i) { places[i] = random_place(tracer, hash(seed, i)); });
  std::vector<float> rooms;
  for (const Place& place : places) rooms.push_back(place.room);
  std::nth_element(rooms.begin(), rooms.begin() + kPoints / 2, rooms.end());
  const float least_distance = kTooNear * rooms[kPoints / 2];

  std::vector<Choice> choices(kPoints);
  parallel_for(kPoints, 8, [&](std::size_t i) {
    choices[i] = best_direction(tracer.world().rays, places, places[i].eye, least_distance);
  });
  return std::max_element(
             choices.begin(), choices.end(),
             [](const Choice& l, const Choice& r) { return l.points_shown < r.points_shown; })
      ->camera;
}

}  // namespace halflight
