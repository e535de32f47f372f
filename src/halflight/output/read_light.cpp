#include "halflight/output/read_light.h"

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"
#include "halflight/transport/outer_light.h"

namespace halflight {

SolutionReader::SolutionReader(const SolverState& state, const ReadOptions& options)
    : state_(&state), options_(options), emitters_(*state.world) {}

Rgb SolutionReader::direct(const Vec3& x, const Vec3& n) const {
  return emitters_.irradiance(x, n, options_.direct) + punctual_irradiance(*state_->world, x, n);
}

Rgb SolutionReader::sky(const Vec3& x, const Vec3& n) const {
  return sky_irradiance(*state_->world, x, n, options_.gather_rays, Vec2(0.5f));
}

Rgb SolutionReader::reflected_radiosity(const RayHit& hit) const {
  const World& world = *state_->world;
  const SideId side = side_of(state_->surfaces->of_triangle[hit.triangle], !hit.front);
  const auto [a, b, c] = world.geometry.corners(hit.triangle);
  const Vec3 at = a + hit.barycentric.x * (b - a) + hit.barycentric.y * (c - a);
  const ElementId leaf = state_->tree.find_leaf(side, at);
  if (!leaf.valid()) return Rgb(0.f);
  return reflectance_at(world.scene, world.geometry, hit.triangle, hit.barycentric) *
         state_->irradiance[leaf];
}

void SolutionReader::gather(const Vec3& x, const Vec3& n, Rgb& reflected, Rgb& sky) const {
  const World& world = *state_->world;
  const Frame frame = Frame::from_normal(n);
  const Vec3 from = world.rays.lift(x, n);
  reflected = sky = Rgb(0.f);
  for (int k = 0; k < options_.gather_rays; ++k) {
    const auto index = static_cast<std::uint32_t>(k);
    const Vec3 w = frame.to_world(cosine_hemisphere(r2_sequence(index)));
    if (const auto hit = world.rays.closest_hit(from, w, kInfinity, hash(index)))
      reflected += reflected_radiosity(*hit);
    else
      sky += kPi * world.scene.sky;
  }
  reflected /= static_cast<float>(options_.gather_rays);
  sky /= static_cast<float>(options_.gather_rays);
}

Reading SolutionReader::read(const ReadingPoint& point) const {
  Reading reading;
  Rgb sky;
  gather(point.position, point.normal, reading.indirect, sky);
  reading.direct = direct(point.position, point.normal) + sky;
  return reading;
}

std::vector<Reading> SolutionReader::operator()(std::span<const ReadingPoint> points) const {
  std::vector<Reading> readings(points.size());
  parallel_for(points.size(), 16, [&](std::size_t i) { readings[i] = read(points[i]); });
  return readings;
}

}  // namespace halflight
