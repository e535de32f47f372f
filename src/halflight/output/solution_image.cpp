#include "halflight/output/solution_image.h"

#include <atomic>
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

// Rays through the pixels of a picture, the same ones each time, and what they meet.
class PictureRays {
 public:
  PictureRays(const World& world, const CameraRays& camera, int width, int height, int samples)
      : world_(world),
        camera_(camera),
        columns_(static_cast<std::size_t>(width)),
        pixels_(columns_ * static_cast<std::size_t>(height)),
        samples_(samples) {}

  // Mean over the rays of each pixel of the light that arrives, where `leaving` gives that of a
  // surface by its hit and the ray's place in the pixel. Panes of glass one behind the other each
  // add their share. In parallel; ends early once the progress is cancelled.
  template <class Leaving, class Done>
  void trace(const Progress& progress, const char* phase, const Leaving& leaving,
             const Done& done) const {
    const std::size_t band = kRowsPerReport * columns_;
    for (std::size_t first = 0; first < pixels_ && !progress.cancelled(); first += band) {
      const std::size_t count = std::min(band, pixels_ - first);
      parallel_for(count, 16, [&](std::size_t i) {
        const std::size_t pixel = first + i;
        const std::size_t row = pixel / columns_;
        const Vec2 corner(static_cast<float>(pixel % columns_), static_cast<float>(row));
        Rgb sum(0.f);
        for (int k = 0; k < samples_; ++k) {
          const Vec2 shift = r2_sequence(static_cast<std::uint32_t>(k));
          sum += radiance(camera_.through(corner + shift),
                          [&](const RayHit& hit) { return leaving(hit, shift); });
        }
        done(pixel, sum / static_cast<float>(samples_));
      });
      progress.report(phase, static_cast<double>(first + count) / static_cast<double>(pixels_));
    }
  }

 private:
  template <class Leaving>
  Rgb radiance(const CameraRay& ray, const Leaving& leaving) const {
    Rgb sum(0.f);
    float left = 1.f;  // share of what lies behind that is seen
    Vec3 origin = ray.origin;
    for (int pane = 0; pane < kMostPanes && left > kBlockedBelow; ++pane) {
      const auto hit = world_.rays.first_surface(origin, ray.direction, kInfinity);
      if (!hit) return sum + left * world_.scene.sky;
      const float opacity =
          opacity_at(world_.scene, world_.geometry, hit->triangle, hit->barycentric);
      sum += left * opacity * leaving(*hit);
      left *= 1.f - opacity;
      origin =
          world_.rays.lift(hit_position(world_.geometry, *hit), -hit_normal(world_.geometry, *hit));
    }
    return sum;
  }

  const World& world_;
  const CameraRays& camera_;
  std::size_t columns_, pixels_;
  int samples_;
};

IdVector<TriangleId, ShownSides> sides_seen(const PictureRays& rays, std::size_t triangles,
                                            const Progress& progress) {
  IdVector<TriangleId, ShownSides> seen(triangles, {.front = false, .back = false});
  rays.trace(
      progress, "view",
      [&](const RayHit& hit, Vec2) {
        ShownSides& sides = seen[hit.triangle];
        std::atomic_ref(hit.front ? sides.front : sides.back)
            .store(true, std::memory_order_relaxed);
        return Rgb(0.f);
      },
      [](std::size_t, const Rgb&) {});
  return seen;
}

}  // namespace

Image solution_image(const SolverState& state, const LitMeshOptions& mesh_options,
                     const CameraRays& camera, int width, int height, int samples_per_pixel,
                     const Progress& progress) {
  const World& world = *state.world;
  const PictureRays rays(world, camera, width, height, samples_per_pixel);
  const SolutionReader reader(state, kPictureReading);
  const LitMesh mesh = build_lit_mesh(
      world.scene, world.geometry, sides_seen(rays, world.geometry.triangles.size(), progress),
      [&](std::span<const ReadingPoint> points) { return reader.indirect(points, progress); },
      mesh_options, progress);
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
  Image image(width, height);
  rays.trace(progress, "picture", leaving,
             [&](std::size_t pixel, const Rgb& light) { image.pixels[pixel] = light; });
  return image;
}

}  // namespace halflight
