#include "experiments/cube_wall.h"

#include <algorithm>

#include "halflight/base/parallel.h"
#include "halflight/features/feature_mask.h"
#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/procedural/cube_groups.h"

namespace halflight::experiments {
namespace {

// Wall in the plane z = 0, light around (0, 0, kLightDistance); see the scene.
constexpr float kPixel = 0.01f;        // metres
constexpr float kLightDistance = 3.f;  // metres
constexpr float kLightSide = 0.04f;    // metres
constexpr int kLightSamples = 8;       // along each side of the light

Vec3 pixel_centre(int x, int y) {
  const float half = 0.5f * kWallPixels;
  return kPixel *
         Vec3(static_cast<float>(x) + 0.5f - half, half - static_cast<float>(y) - 0.5f, 0.f);
}

float seen_share(const RayScene& rays, const Vec3& on_wall) {
  const Vec3 from = rays.lift(on_wall, Vec3(0.f, 0.f, 1.f));
  float seen = 0.f;
  for (int i = 0; i < kLightSamples; ++i)
    for (int j = 0; j < kLightSamples; ++j) {
      const Vec2 place = (Vec2(i, j) + 0.5f) / static_cast<float>(kLightSamples) - 0.5f;
      const Vec3 on_light(kLightSide * place, kLightDistance);
      seen += rays.transmittance(from, rays.lift(on_light, Vec3(0.f, 0.f, -1.f)));
    }
  return seen / (kLightSamples * kLightSamples);
}

// Small light and wall face each other: both cosines and the distance give cos^4.
float falloff(const Vec3& on_wall) {
  const float cos2 = kLightDistance * kLightDistance /
                     (kLightDistance * kLightDistance + glm::dot(on_wall, on_wall));
  return cos2 * cos2;
}

}  // namespace

CubeWall light_cube_wall(int group, int seed) {
  CubeGroupsParameters parameters;
  parameters.group = group;
  parameters.seed = seed;
  const Scene scene = cube_groups_scene(parameters);
  const Geometry geometry = flatten(scene);
  const RayScene rays(scene, geometry);

  CubeWall wall{Image(kWallPixels, kWallPixels), {}, {}};
  wall.visibility.resize(wall.reference.pixels.size());
  parallel_for(kWallPixels, 4, [&](std::size_t row) {
    for (int x = 0; x < kWallPixels; ++x) {
      const int y = static_cast<int>(row);
      const Vec3 on_wall = pixel_centre(x, y);
      const float seen = seen_share(rays, on_wall);
      wall.visibility[row * kWallPixels + static_cast<std::size_t>(x)] = seen;
      wall.reference.at(x, y) = Rgb(static_cast<float>(kFullLight) * seen * falloff(on_wall));
    }
  });
  wall.shadow = shadow_of(wall.visibility, kWallPixels, kWallPixels);
  return wall;
}

Image averaged_over_cells(const Image& reference, int cell) {
  Image coarse(reference.width, reference.height);
  for (int top = 0; top < reference.height; top += cell)
    for (int left = 0; left < reference.width; left += cell) {
      const int bottom = std::min(reference.height, top + cell);
      const int right = std::min(reference.width, left + cell);
      glm::dvec3 sum(0);
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) sum += glm::dvec3(reference.at(x, y));
      const Rgb mean(sum / static_cast<double>((bottom - top) * (right - left)));
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) coarse.at(x, y) = mean;
    }
  return coarse;
}

Image grey_picture(const Image& levels) {
  Image picture = levels;
  for (Rgb& c : picture.pixels) c /= static_cast<float>(kFullLight);
  return picture;
}

Image mask_picture(const BinaryImage& mask) {
  Image picture(mask.width(), mask.height());
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) picture.at(x, y) = Rgb(mask.at(x, y) ? 0.f : 1.f);
  return picture;
}

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace halflight::experiments
