#include "halflight/rays/path_traced_image.h"

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr std::size_t kRowsPerReport = 16;

// Calls shade(x, y, seed of the pixel) for every pixel, a band of rows after the other.
template <class Shade>
Image shade_pixels(int width, int height, std::uint64_t seed, const Progress& progress,
                   const Shade& shade) {
  Image image(width, height);
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t band = kRowsPerReport * columns;
  for (std::size_t first = 0; first < image.pixels.size(); first += band) {
    if (progress.cancelled()) break;
    parallel_for(std::min(band, image.pixels.size() - first), 16, [&](std::size_t i) {
      const std::size_t pixel = first + i;
      const std::size_t row = pixel / columns;
      const Vec2 corner(static_cast<float>(pixel % columns), static_cast<float>(row));
      image.pixels[pixel] = shade(corner, hash(seed, pixel));
    });
    const std::size_t done = std::min(first + band, image.pixels.size());
    progress.report("picture",
                    static_cast<double>(done) / static_cast<double>(image.pixels.size()));
  }
  return image;
}

}  // namespace

Image path_traced_image(const PathTracer& tracer, const CameraRays& camera, int width, int height,
                        std::uint32_t samples_per_pixel, std::uint64_t seed,
                        const Progress& progress) {
  return shade_pixels(width, height, seed, progress, [&](Vec2 corner, std::uint64_t pixel_seed) {
    Rgb sum(0.f);
    for (std::uint32_t i = 0; i < samples_per_pixel; ++i) {
      PathSampler sampler(pixel_seed, i);
      const CameraRay ray = camera.through(corner + sampler.next_pair());
      sum += tracer.radiance(ray.origin, ray.direction, sampler);
    }
    return sum / static_cast<float>(std::max(1u, samples_per_pixel));
  });
}

Image visibility_image(const PathTracer& tracer, const CameraRays& camera, int width, int height,
                       std::uint32_t samples_per_pixel, std::uint64_t seed,
                       const Progress& progress) {
  return shade_pixels(width, height, seed, progress, [&](Vec2 corner, std::uint64_t pixel_seed) {
    const CameraRay ray = camera.through(corner + Vec2(0.5f));
    const auto hit =
        tracer.world().rays.closest_hit(ray.origin, ray.direction, kInfinity, pixel_seed);
    if (!hit) return Rgb(1.f);
    const SurfacePoint seen = surface_point(tracer.world().geometry, *hit);
    return Rgb(tracer.direct_visibility(seen.position, seen.normal, samples_per_pixel, pixel_seed));
  });
}

}  // namespace halflight
