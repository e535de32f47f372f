#include "halflight/rays/emitters.h"

#include "halflight/rays/sampling.h"
#include "halflight/scene/punctual_light.h"

namespace halflight {
namespace {

// Lookups per textured emitter to learn its mean radiance, and the share of the untextured radiance
// below which the mean is not believed (a bright texel may have been missed).
constexpr std::uint32_t kTextureSamples = 16;
constexpr float kLeastTextureShare = 0.05f;

LightBounds bounds_of(const PunctualLight& light) {
  LightBounds b;
  b.bounds.extend(light.position);
  b.axis = light.direction;
  b.cos_cone = light.kind == Light::Kind::spot ? light.cos_outer : -1.f;
  b.intensity = average(light.intensity);
  return b;
}

}  // namespace

LightBounds Emitters::bounds_of(TriangleId triangle) const {
  const Material& material = scene_->materials[geometry_->materials[triangle]];
  float mean = average(material.emission);
  if (material.emission_texture.valid()) {
    float sum = 0.f;
    for (std::uint32_t i = 0; i < kTextureSamples; ++i)
      sum += average(emission_at(*scene_, *geometry_, triangle, uniform_triangle(r2_sequence(i))));
    mean = std::max(sum / static_cast<float>(kTextureSamples), kLeastTextureShare * mean);
  }
  LightBounds b;
  for (const Vec3& corner : geometry_->corners(triangle)) b.bounds.extend(corner);
  const Vec3 normal = geometry_->scaled_normal(triangle);
  const float doubled_area = glm::length(normal);
  b.axis = normal / doubled_area;
  b.two_sided = material.double_sided;
  b.intensity = 0.5f * doubled_area * mean;
  return b;
}

Emitters::Emitters(const Scene& scene, const Geometry& geometry)
    : scene_(&scene), geometry_(&geometry) {
  std::vector<LightBounds> lights;
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const TriangleId t(i);
    if (!scene.materials[geometry.materials[t]].emits()) continue;
    if (of_triangle_.empty()) of_triangle_.resize(geometry.triangles.size());
    of_triangle_[t] = places_.push_back({t, 0});
    lights.push_back(bounds_of(t));
  }
  for (std::uint32_t i = 0; i < geometry.lights.size(); ++i) {
    const PunctualLight& light = geometry.lights[i];
    if (light.kind == Light::Kind::directional) {
      directional_.push_back(light);
      continue;
    }
    places_.push_back({TriangleId(), i});
    lights.push_back(halflight::bounds_of(light));
  }
  tree_ = LightTree(lights);
}

std::optional<LightSample> Emitters::sample(const Vec3& p, const Vec3& n, float u_light,
                                            Vec2 u) const {
  const std::optional<LightTree::Choice> choice = tree_.choose(p, n, u_light);
  if (!choice) return std::nullopt;
  const Place& place = places_[choice->emitter];
  if (place.triangle.valid()) return sample_triangle(place.triangle, p, n, u, choice->probability);

  const PunctualLight& light = geometry_->lights[place.punctual];
  const float cosine = glm::dot(n, direction_to(light, p));
  if (!(cosine > 0.f)) return std::nullopt;
  LightSample s;
  s.point = light.position;
  s.irradiance = facing_irradiance(light, p) * (cosine / choice->probability);
  return s;
}

// E = L cos(theta_r) cos(theta_e) A / d^2 / probability, the point being uniform over the area A.
std::optional<LightSample> Emitters::sample_triangle(TriangleId triangle, const Vec3& p,
                                                     const Vec3& n, Vec2 u,
                                                     float probability) const {
  const Vec2 barycentric = uniform_triangle(u);
  const Vec3 normal = geometry_->scaled_normal(triangle);
  LightSample s;
  s.point = geometry_->point(triangle, barycentric);
  const Vec3 offset = s.point - p;
  const float facing = -glm::dot(normal, offset);  // 2 A d cos(theta_e)
  const float receiving = glm::dot(n, offset);     // d cos(theta_r)
  const float distance_squared = glm::dot(offset, offset);
  if (!(receiving > 0.f) || facing == 0.f || !(distance_squared > 0.f)) return std::nullopt;

  const Rgb emitted = radiance(triangle, barycentric, facing > 0.f);
  if (!(max_component(emitted) > 0.f)) return std::nullopt;
  const float distance = std::sqrt(distance_squared);
  const float projected_area = 0.5f * std::abs(facing) / distance;
  s.triangle = triangle;
  s.density = probability * distance_squared / projected_area;
  s.normal = glm::normalize(facing > 0.f ? normal : -normal);
  const float opacity = opacity_at(*scene_, *geometry_, triangle, barycentric);
  s.irradiance = emitted * (opacity * receiving / distance / s.density);
  return s;
}

float Emitters::density(TriangleId triangle, const Vec3& p, const Vec3& n,
                        const Vec3& offset) const {
  const float distance_squared = glm::dot(offset, offset);
  const float facing = std::abs(glm::dot(geometry_->scaled_normal(triangle), offset));
  if (!(facing > 0.f)) return 0.f;
  const float projected_area = 0.5f * facing / std::sqrt(distance_squared);
  return tree_.probability(of_triangle_[triangle], p, n) * distance_squared / projected_area;
}

Rgb Emitters::radiance(TriangleId triangle, Vec2 barycentric, bool front) const {
  const Material& material = scene_->materials[geometry_->materials[triangle]];
  if (!material.emits() || !(front || material.double_sided)) return Rgb(0.f);
  return emission_at(*scene_, *geometry_, triangle, barycentric);
}

}  // namespace halflight
