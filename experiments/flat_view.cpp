#include "experiments/flat_view.h"

#include <cmath>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/features/feature_mask.h"

namespace halflight::experiments {
namespace {

// Rays start over a rectangle that `right` and `down` span from its upper left corner.
FlatView view_through(const World& world, std::string name, const Vec3& corner, const Vec3& right,
                      const Vec3& down, int pixels) {
  FlatView view;
  view.name = std::move(name);
  const float across = glm::length(right), along = glm::length(down);
  view.pixel = std::max(across, along) / static_cast<float>(pixels);
  view.width = std::max(1, static_cast<int>(std::lround(across / view.pixel)));
  view.height = std::max(1, static_cast<int>(std::lround(along / view.pixel)));
  const Vec3 direction = glm::normalize(glm::cross(right, down));
  view.points.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  parallel_for(view.points.size(), 256, [&](std::size_t i) {
    const auto columns = static_cast<std::size_t>(view.width);
    const float x = (static_cast<float>(i % columns) + 0.5f) / static_cast<float>(view.width);
    const float y = (static_cast<float>(i / columns) + 0.5f) / static_cast<float>(view.height);
    const auto hit =
        world.rays.closest_hit(corner + x * right + y * down, direction, kInfinity, hash(i));
    if (!hit) return;
    view.points[i] = {hit_position(world.geometry, *hit), hit_normal(world.geometry, *hit),
                      hit->triangle};
  });
  return view;
}

}  // namespace

FlatView view_of_floor(const World& world, float from_height, int pixels) {
  const Bounds3f& b = world.geometry.bounds;
  const Vec3 e = b.extent();
  const Vec3 corner(b.lower.x, b.lower.y + from_height * e.y, b.lower.z);
  return view_through(world, "floor", corner, {e.x, 0.f, 0.f}, {0.f, 0.f, e.z}, pixels);
}

FlatView view_of_wall(const World& world, int pixels) {
  const Bounds3f& b = world.geometry.bounds;
  const Vec3 e = b.extent();
  const Vec3 corner(b.lower.x, b.upper.y, b.center().z);
  return view_through(world, "wall", corner, {e.x, 0.f, 0.f}, {0.f, -e.y, 0.f}, pixels);
}

Image irradiance_picture(const FlatView& view, const LightReader& read) {
  std::vector<ReadingPoint> points;
  for (const ReadingPoint& p : view.points)
    if (p.triangle.valid()) points.push_back(p);
  const std::vector<Reading> readings = read(points);
  Image picture(view.width, view.height);
  for (std::size_t i = 0, next = 0; i < view.points.size(); ++i)
    if (view.points[i].triangle.valid()) picture.pixels[i] = readings[next++].irradiance();
  return picture;
}

Image traced_picture(const FlatView& view, const PathTracer& tracer, std::uint32_t samples,
                     std::uint64_t seed) {
  Image picture(view.width, view.height);
  parallel_for(view.points.size(), 16, [&](std::size_t i) {
    const ReadingPoint& p = view.points[i];
    if (p.triangle.valid())
      picture.pixels[i] =
          tracer.estimate_irradiance(p.position, p.normal, samples, hash(seed, i)).mean;
  });
  return picture;
}

BinaryImage shadow_in(const FlatView& view, const PathTracer& tracer, std::uint32_t samples) {
  std::vector<float> seen(view.points.size(), 1.f);
  parallel_for(seen.size(), 16, [&](std::size_t i) {
    const ReadingPoint& p = view.points[i];
    if (p.triangle.valid())
      seen[i] = tracer.direct_visibility(p.position, p.normal, samples, hash(i));
  });
  return shadow_of(seen, view.width, view.height);
}

double mean_of(const Image& picture) {
  double sum = 0.0;
  for (const Rgb& p : picture.pixels) sum += static_cast<double>(average(p));
  return sum / static_cast<double>(picture.pixels.size());
}

}  // namespace halflight::experiments
