// Reads a solution: direct light evaluated afresh through a cut over the emitters with exact rays,
// indirect light by a final gather whose rays end in the solved radiosity. Vertices, sensors and
// pixels all come here.
#pragma once

#include <memory>
#include <optional>

#include "halflight/output/light_reader.h"
#include "halflight/output/smooth_irradiance.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/solve/solver.h"
#include "halflight/transport/emitter_tree.h"

namespace halflight {

struct ReadOptions {
  // Of each point's hemisphere. None: indirect light is that of the cell, made linear over it.
  int gather_rays = 1024;
  // Of a place nearer than this, in sizes of its cell, the cell says little (gaps, corners): gather
  // rays that end there go on as paths. Of bright cells from as much further as they are brighter
  // than the scene (insides of lamps). 0: nowhere.
  float near_hits = 0.5f;
  // Places brighter than the scene's mean take more rays, in proportion: so much larger are their
  // errors.
  bool more_where_bright = false;
  // Paths have noise of their own at every place, which averages out over places. Of neighbours in
  // a picture or a mesh it would show: there all err alike.
  bool own_noise = true;
  DirectLightOptions direct;
};

// For the many vertices of a lit mesh. Fewer gather rays make more vertices, by their noise. Those
// in gaps, which nobody sees, would take as long as all others.
inline constexpr ReadOptions kMeshReading{
    .gather_rays = 196,
    .near_hits = 0.f,
    .own_noise = false,
    .direct = {.shadow_rays = 8, .penumbra_rays = 24, .largest_group_share = 0.03f}};
inline constexpr ReadOptions kPictureReading{
    .gather_rays = 256,
    .own_noise = false,
    .direct = {.shadow_rays = 8, .penumbra_rays = 48, .largest_group_share = 0.03f}};

// Length of edges that a lit mesh need not split: half the smallest feature size of any place.
float finest_mesh_edge(const SolverState& state);

// For sensors: as many rays as the error that is aimed at asks for.
ReadOptions sensor_reading(const SolverState& state);

class SolutionReader {
 public:
  // Refers to the state, which must outlive the reader.
  SolutionReader(const SolverState& state, const ReadOptions& options);
  SolutionReader(const SolutionReader&) = delete;
  SolutionReader& operator=(const SolutionReader&) = delete;

  Reading read(const ReadingPoint& point) const;
  // In parallel. Once the progress is cancelled what is left is taken from the cells.
  std::vector<Reading> operator()(std::span<const ReadingPoint> points,
                                  const Progress& progress = {}) const;
  // The same without the direct part, for pictures, which read that in every pixel.
  std::vector<Reading> indirect(std::span<const ReadingPoint> points,
                                const Progress& progress = {}) const;
  // The light of the cell that the point lies in, without a ray: blocky, and at once.
  Reading of_cell(const ReadingPoint& point) const;

  // Inside of a closed body that stands on the surface.
  bool is_covered(const ReadingPoint& point) const;
  // Of each point, in parallel: 1 when it is.
  std::vector<std::uint8_t> covered(std::span<const ReadingPoint> points) const;

  // Emitting surfaces, punctual lights and sky. Different shifts put shadow rays elsewhere: a
  // pixel's samples each have their own, the same for all pixels, so that steps in penumbrae
  // average out and no noise comes in.
  Rgb direct(const Vec3& x, const Vec3& n, Vec2 shift = Vec2(0.5f)) const;
  // Solved radiosity less emission of what a ray has hit.
  Rgb reflected_radiosity(const RayHit& hit) const;

 private:
  // Of a point on a triangle.
  ElementId leaf_at(const ReadingPoint& point) const;
  // Whether a cell says too little about a place of it that is seen from so near.
  bool is_near(float distance, ElementId leaf) const;
  // As many times the rays of others a place takes that receives this much reflected light.
  float times_the_rays(const Rgb& indirect) const;
  int gather_rays() const;
  Rgb reflected_radiosity(const RayHit& hit, ElementId leaf) const;
  Reading read_from_cell(const ReadingPoint& point) const;
  bool matters_to_nobody(const ReadingPoint& point) const;
  RadianceAt bright_radiance() const;  // refers to the reader
  // Light reflected at least once.
  Rgb gather(const Vec3& x, const Vec3& n, int rays) const;
  Rgb gather(const ReadingPoint& point) const;
  // By a path that ends where cells are far enough away.
  Rgb reflected_radiosity_by_path(const RayHit& hit, PathSampler sampler) const;
  // Of paths that go on from the gather of a place.
  std::uint64_t seed_of(const Vec3& x) const;

  const SolverState* state_;
  ReadOptions options_;
  EmitterTree emitters_;
  PathTracer paths_;
  SmoothIrradiance irradiance_;
  float mean_irradiance_ = 0.f, mean_reflected_ = 0.f;  // of the scene, W/m2
  // Cells so bright by reflection (in and around lamps) that the few rays of a gather that meet
  // them would show: they are read like emitters, and the gather leaves them out.
  IdVector<ElementId, std::uint8_t> is_bright_;
  EmitterTree bright_;
  std::optional<SmoothIrradiance> indirect_;  // where there are no rays to gather with
};

}  // namespace halflight
