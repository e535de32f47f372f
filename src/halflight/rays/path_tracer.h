// The reference: unbiased diffuse path tracing, independent of all radiosity code.
// One light sample and one cosine-distributed ray per bounce, joined by multiple importance
// sampling (Veach 1997, power heuristic), ended by Russian roulette; no depth limit.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "halflight/base/vec.h"
#include "halflight/rays/emitters.h"
#include "halflight/rays/path_rays.h"
#include "halflight/rays/path_sampler.h"
#include "halflight/rays/world.h"

namespace halflight {

struct IrradianceEstimate {
  Rgb mean{0.f};            // W/m2 (or lux)
  Rgb standard_error{0.f};  // of the mean; infinite for fewer than 2 samples
};

// What a path that meets a surface need not find out: the radiosity there less emission, W/m2.
// None: it is not known, and the path goes on.
using KnownRadiosity = std::function<std::optional<Rgb>(const RayHit&)>;

class PathTracer {
 public:
  // Refers to the world, which must outlive it. Thread-safe. With rays of somebody else's
  // (which must outlive it too) all direct light goes through their shadow rays and nothing is left
  // to chance hits of emitters: their bias shows in full.
  explicit PathTracer(const World& world, const PathRays* rays = nullptr)
      : world_(&world), rays_(rays), emitters_(world.scene, world.geometry) {}

  // Irradiance on the side of a surface that the unit normal points to; the point lies on the
  // surface or in the air. The standard error comes from up to 16 independent batches of
  // stratified samples.
  IrradianceEstimate estimate_irradiance(const Vec3& point, const Vec3& normal,
                                         std::uint32_t samples, std::uint64_t seed) const;

  // The same by one path.
  Rgb irradiance_by_one_path(Vec3 p, Vec3 n, PathSampler& sampler,
                             const KnownRadiosity& known = {}) const;

  // One-path estimate of the radiance that arrives at `origin` against `direction`. Sky and
  // emitters are visible.
  Rgb radiance(const Vec3& origin, const Vec3& direction, PathSampler& sampler) const;

  // Share of the direct light of emitters and lights (the sky apart) that reaches this side of the
  // surface: 1 exactly when every sample is unoccluded or no light faces the side.
  float direct_visibility(const Vec3& point, const Vec3& normal, std::uint32_t samples,
                          std::uint64_t seed) const;

  const World& world() const { return *world_; }
  const Emitters& emitters() const { return emitters_; }

 private:
  Rgb sampled_light(const Vec3& p, const Vec3& n, PathSampler& sampler) const;
  Rgb directional_light(const Vec3& p, const Vec3& n) const;

  const World* world_;
  const PathRays* rays_;  // null: exact
  Emitters emitters_;
};

// Where a ray met a surface, and the side that it met.
struct SurfacePoint {
  Vec3 position{0.f};
  Vec3 normal{0.f, 1.f, 0.f};  // geometric, unit, towards the ray
};
SurfacePoint surface_point(const Geometry& geometry, const RayHit& hit);

}  // namespace halflight
