#include "halflight/output/solution_image.h"

#include <memory>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::size_t kRowsPerReport = 16;
constexpr int kMostPanes = 32;

// The lit triangles that show one side of the surfaces, ready to be found by rays.
class LitSide {
 public:
  LitSide(const Scene& scene, const LitMesh& mesh, bool back) {
    for (const LitPrimitive& p : mesh.primitives)
      if (p.back == back) append(p);
    rays_ = std::make_unique<RayScene>(scene, geometry_);
  }

  // Indirect irradiance at a point of the side whose unit normal is n; none: not part of the mesh.
  std::optional<Rgb> indirect(const Vec3& x, const Vec3& n) const {
    const float reach = 4.f * rays_->lift_distance();
    const auto hit = rays_->closest_hit(x + reach * n, -n, 2.f * reach, 0);
    if (!hit) return std::nullopt;
    const auto& v = geometry_.triangles[hit->triangle];
    const Vec2 b = hit->barycentric;
    return (1.f - b.x - b.y) * indirect_[v[0]] + b.x * indirect_[v[1]] + b.y * indirect_[v[2]];
  }

 private:
  void append(const LitPrimitive& p) {
    const auto base = static_cast<std::uint32_t>(geometry_.positions.size());
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
      geometry_.positions.push_back(p.positions[i]);
      geometry_.bounds.extend(p.positions[i]);
      indirect_.push_back(p.indirect[i]);
    }
    for (const auto& t : p.triangles) {
      geometry_.triangles.push_back(
          {VertexId(base + t[0]), VertexId(base + t[1]), VertexId(base + t[2])});
      geometry_.materials.push_back(kOpaqueMaterial);
    }
  }

  // Lit triangles stand for their place alone: nothing of them is transparent to the search.
  static constexpr MaterialId kOpaqueMaterial{std::size_t{0}};
  Geometry geometry_;
  IdVector<VertexId, Rgb> indirect_;
  std::unique_ptr<RayScene> rays_;
};

Scene opaque_scene() {
  Scene scene;
  scene.materials.push_back({});
  return scene;
}

}  // namespace

Image solution_image(const SolverState& state, const SolutionReader& reader, const LitMesh& mesh,
                     const CameraRays& camera, int width, int height, int samples_per_pixel,
                     const Progress& progress) {
  const World& world = *state.world;
  const Scene search = opaque_scene();
  const LitSide front(search, mesh, false), back(search, mesh, true);

  const auto leaving = [&](const RayHit& hit, Vec2 shift) {
    const Vec3 x = hit_position(world.geometry, hit), n = hit_normal(world.geometry, hit);
    const auto indirect = (hit.front ? front : back).indirect(x, n);
    const Rgb irradiance = indirect ? reader.direct(x, n, shift) + *indirect
                                    : reader.read({x, n, hit.triangle}).irradiance();
    Rgb result = reflectance_at(world.scene, world.geometry, hit.triangle, hit.barycentric) *
                 irradiance / kPi;
    const Material& m = world.scene.materials[world.geometry.materials[hit.triangle]];
    if (hit.front || m.double_sided)
      result += emission_at(world.scene, world.geometry, hit.triangle, hit.barycentric);
    return result;
  };
  // Panes of glass one behind the other each add their share.
  const auto radiance = [&](const CameraRay& ray, Vec2 shift) {
    Rgb sum(0.f);
    float left = 1.f;  // share of what lies behind that is seen
    Vec3 origin = ray.origin;
    for (int pane = 0; pane < kMostPanes && left > kBlockedBelow; ++pane) {
      const auto hit = world.rays.first_surface(origin, ray.direction, kInfinity);
      if (!hit) return sum + left * world.scene.sky;
      const float opacity =
          opacity_at(world.scene, world.geometry, hit->triangle, hit->barycentric);
      sum += left * opacity * leaving(*hit, shift);
      left *= 1.f - opacity;
      origin =
          world.rays.lift(hit_position(world.geometry, *hit), -hit_normal(world.geometry, *hit));
    }
    return sum;
  };

  Image image(width, height);
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t band = kRowsPerReport * columns;
  for (std::size_t first = 0; first < image.pixels.size() && !progress.cancelled(); first += band) {
    const std::size_t count = std::min(band, image.pixels.size() - first);
    parallel_for(count, 16, [&](std::size_t i) {
      const std::size_t pixel = first + i;
      const std::size_t row = pixel / columns;
      const Vec2 corner(static_cast<float>(pixel % columns), static_cast<float>(row));
      Rgb sum(0.f);
      for (int k = 0; k < samples_per_pixel; ++k) {
        const Vec2 shift = r2_sequence(static_cast<std::uint32_t>(k));
        sum += radiance(camera.through(corner + shift), shift);
      }
      image.pixels[pixel] = sum / static_cast<float>(samples_per_pixel);
    });
    progress.report("picture",
                    static_cast<double>(first + count) / static_cast<double>(image.pixels.size()));
  }
  return image;
}

}  // namespace halflight
