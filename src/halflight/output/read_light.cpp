#include "halflight/output/read_light.h"

#include <bit>

#include "halflight/base/parallel.h"
#include "halflight/rays/adaptive_hemisphere.h"
#include "halflight/rays/sampling.h"
#include "halflight/solve/importance.h"
#include "halflight/transport/outer_light.h"

namespace halflight {

namespace {

constexpr int kLeastSkyRays = 64;

// Cells this much brighter than the scene's mean radiosity are read like emitters.
constexpr float kBright = 4.f;
constexpr float kFinestEdge = 1e-3f;  // of the scene's diagonal
constexpr float kErrorOfPlainReading = 0.05f;
constexpr float kLeastReading = 1.f / 32.f, kMostReading = 8.f;
// Of an emitter that a sensor sees through a small opening, few rays would meet anything.
constexpr int kSensorShadowRays = 32, kFewestSensorShadowRays = 8;
constexpr int kSensorPenumbraRays = 1024, kFewestSensorPenumbraRays = 32;
// Of a bright cell: rays from so many times as far end nearby.
constexpr float kMostTimesAsFar = 16.f;
// A bright place takes at most so many times the rays.
constexpr float kMostTimesTheRays = 64.f;
// From so many means of the scene on, cells are too rough, and places gather.
constexpr float kBrightForCells = 2.f;
constexpr int kRaysInsteadOfCells = 32;  // where the mean comes in

float reflected_by(const SolverState& state, ElementId cell) {
  return average(state.reflectance[cell] * state.irradiance[cell]);
}

// W/m2, of all leaf cells that reflect.
float mean_reflected(const SolverState& state) {
  double sum = 0.0, area = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) continue;
    const float reflected = reflected_by(state, e);
    if (!(reflected > 0.f)) continue;
    sum += static_cast<double>(state.tree[e].area * reflected);
    area += static_cast<double>(state.tree[e].area);
  }
  return area > 0.0 ? static_cast<float>(sum / area) : 0.f;
}

// Cells that reflect much more light than the mean, cut into triangles.
std::vector<EmittingSide> find_bright_cells(const SolverState& state, float mean_reflected,
                                            IdVector<ElementId, std::uint8_t>& is_bright) {
  is_bright = IdVector<ElementId, std::uint8_t>(state.tree.size(), 0);
  std::vector<EmittingSide> bright;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId cell(i);
    if (!state.tree[cell].is_leaf_cell() || !(reflected_by(state, cell) > kBright * mean_reflected))
      continue;
    is_bright[cell] = 1;
    const SideId side = state.tree[cell].side;
    EmittingSide emitter;
    emitter.triangle = state.surfaces->triangles[(*state.surfaces)[side].first_triangle];
    emitter.cell = cell;
    emitter.back = is_back(side);
    emitter.varies = true;
    emitter.radiance = state.reflectance[cell] * state.irradiance[cell] / kPi;
    state.tree.for_each_piece(cell, [&](std::span<const Vec3> corners) {
      for (std::size_t k = 2; k < corners.size(); ++k) {
        emitter.corners = {corners[0], corners[k - 1], corners[k]};
        const float area = 0.5f * glm::length(glm::cross(emitter.corners[1] - corners[0],
                                                         emitter.corners[2] - corners[0]));
        emitter.power = average(emitter.radiance) * area;
        if (emitter.power > 0.f) bright.push_back(emitter);
      }
    });
  }
  return bright;
}

ReadOptions with_feature_size(ReadOptions options, float feature_size) {
  options.direct.feature_size = feature_size;
  return options;
}

// Bright surfaces are a part of what is gathered, and worth no more rays than the rest.
DirectLightOptions bright_options(DirectLightOptions options, int gather_rays) {
  options.shadow_rays = std::clamp(gather_rays / 8, 1, options.shadow_rays);
  options.penumbra_rays = std::clamp(gather_rays / 2, 1, options.penumbra_rays);
  options.largest_group_share =
      std::max(options.largest_group_share, 2.f / static_cast<float>(gather_rays));
  return options;
}

// Of leaf cells; with refined links, direct light of emitters as well.
IdVector<ElementId, Rgb> indirect_irradiance(const SolverState& state) {
  IdVector<ElementId, Rgb> indirect = state.irradiance;
  parallel_for(indirect.size(), 4096, [&](std::size_t i) {
    const ElementId e(i);
    indirect[e] = glm::max(indirect[e] - state.given_light[e], Rgb(0.f));
  });
  return indirect;
}

// Of the average channel of what sampled links bring to leaf cells: of the mean of the rays that
// each of them is.
IdVector<ElementId, float> variance_of_sampled_light(const SolverState& state) {
  IdVector<ElementId, float> variance(state.tree.size(), 0.f);
  parallel_for(variance.size(), 1024, [&](std::size_t i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) return;
    float sum = 0.f, squares = 0.f;
    const std::span<const Link> links = state.sampled_links.of(e);
    for (const Link& l : links) {
      const float light = l.weight * average(state.radiosity[l.source] - state.exitance[l.source]);
      sum += light;
      squares += light * light;
    }
    const auto n = static_cast<float>(links.size());
    if (n > 1.f) variance[e] = std::max(0.f, squares - sum * sum / n) * n / (n - 1.f);
  });
  return variance;
}

}  // namespace

float finest_mesh_edge(const SolverState& state) {
  const float least = kFinestEdge * state.world->geometry.bounds.diagonal();
  const float smallest = std::max(state.feature_sizes[state.tree.root()], least);
  // Far from the origin, halves of shorter edges would not differ from their ends.
  return std::max(0.5f * std::min(state.options.feature_size, smallest),
                  4.f * state.world->rays.lift_distance());
}

ReadOptions sensor_reading(const SolverState& state) {
  const float more =
      std::clamp(kErrorOfPlainReading / state.options.error, kLeastReading, kMostReading);
  const auto rays = [&](int plain, int least) {
    return std::max(least, static_cast<int>(more * static_cast<float>(plain)));
  };
  ReadOptions options;
  options.gather_rays = rays(options.gather_rays, 1);
  options.more_where_bright = true;
  options.direct.shadow_rays =
      std::clamp(static_cast<int>(std::sqrt(more) * static_cast<float>(kSensorShadowRays)),
                 kFewestSensorShadowRays, kSensorShadowRays);
  const float fewer = std::min(1.f, more * std::sqrt(more));
  options.direct.penumbra_rays = std::max(
      kFewestSensorPenumbraRays, static_cast<int>(fewer * static_cast<float>(kSensorPenumbraRays)));
  return options;
}

SolutionReader::SolutionReader(const SolverState& state, const ReadOptions& options)
    : state_(&state),
      options_(with_feature_size(options, state.options.feature_size)),
      emitters_(*state.visibility, find_emitters(*state.world)),
      paths_(*state.world),
      irradiance_(state),
      mean_irradiance_(mean_irradiance(state)),
      mean_reflected_(mean_reflected(state)),
      bright_(*state.visibility, find_bright_cells(state, mean_reflected_, is_bright_),
              bright_radiance()) {
  if (options.more_where_bright) options_.direct.plain_light = mean_irradiance_;
  if (options.gather_rays == 0)
    indirect_.emplace(state.tree, indirect_irradiance(state), variance_of_sampled_light(state));
}

Rgb SolutionReader::direct(const Vec3& x, const Vec3& n, Vec2 shift) const {
  return emitters_.irradiance(x, n, options_.direct, shift) +
         punctual_irradiance(*state_->visibility, x, n, options_.direct.feature_size) +
         sky_irradiance(*state_->visibility, x, n, std::max(options_.gather_rays, kLeastSkyRays),
                        shift, options_.direct.feature_size);
}

Rgb SolutionReader::reflected_radiosity(const RayHit& hit) const {
  return reflected_radiosity(hit, state_->tree.leaf_hit(hit));
}

Rgb SolutionReader::reflected_radiosity(const RayHit& hit, ElementId leaf) const {
  const World& world = *state_->world;
  if (!leaf.valid()) return Rgb(0.f);
  return reflectance_at(world.scene, world.geometry, hit.triangle, hit.barycentric) *
         irradiance_.at(leaf, hit_position(world.geometry, hit));
}

RadianceAt SolutionReader::bright_radiance() const {
  return [this](const EmittingSide& e, const Vec3& y, float distance) {
    // Rays of a gather are enough to meet what is near.
    if (is_near(distance, e.cell)) return Rgb(0.f);
    return state_->reflectance[e.cell] * irradiance_.at(e.cell, y) / kPi;
  };
}

bool SolutionReader::is_near(float distance, ElementId leaf) const {
  const float in_means = reflected_by(*state_, leaf) / std::max(mean_reflected_, 1e-30f);
  return distance < options_.near_hits * state_->tree.cell_size(leaf) *
                        std::clamp(in_means, 1.f, kMostTimesAsFar);
}

float SolutionReader::times_the_rays(const Rgb& indirect) const {
  if (!options_.more_where_bright) return 1.f;
  // A checkpoint may hold any numbers; what is none of them counts as the mean.
  return std::min(std::max(1.f, average(indirect) / std::max(mean_irradiance_, 1e-30f)),
                  kMostTimesTheRays);
}

std::uint64_t SolutionReader::seed_of(const Vec3& x) const {
  if (!options_.own_noise) return 0;
  return hash(std::bit_cast<std::uint32_t>(x.x), std::bit_cast<std::uint32_t>(x.y),
              std::bit_cast<std::uint32_t>(x.z));
}

int SolutionReader::gather_rays() const {
  // Points in the air lie in no cell.
  return options_.gather_rays > 0 ? options_.gather_rays : kMeshReading.gather_rays;
}

Rgb SolutionReader::gather(const ReadingPoint& point) const {
  const ElementId leaf = point.triangle.valid() ? leaf_at(point) : ElementId();
  const float times =
      leaf.valid() ? times_the_rays(state_->irradiance[leaf] - state_->given_light[leaf]) : 1.f;
  return gather(point.position, point.normal,
                static_cast<int>(times * static_cast<float>(gather_rays())));
}

Rgb SolutionReader::gather(const Vec3& x, const Vec3& n, int rays) const {
  const World& world = *state_->world;
  const Frame frame = Frame::from_normal(n);
  const Vec3 from = world.rays.lift(x, n);
  const std::uint64_t own = seed_of(x);
  std::uint32_t index = 0;
  const Rgb gathered =
      adaptive_cosine_mean(rays, Vec2(0.5f), [&](const Vec3& w, float) -> SeenLight {
        const std::uint32_t ray = index++;
        const auto hit = world.rays.closest_hit(from, frame.to_world(w), kInfinity, hash(ray));
        if (!hit) return Rgb(0.f);
        const ElementId leaf = state_->tree.leaf_hit(*hit);
        if (leaf.valid() && is_near(hit->distance, leaf))
          return {reflected_radiosity_by_path(*hit, PathSampler(own, ray)),
                  reflected_radiosity(*hit, leaf)};
        if (leaf.valid() && is_bright_[leaf] != 0) return Rgb(0.f);
        return reflected_radiosity(*hit, leaf);
      });
  return gathered + bright_.irradiance(x, n, bright_options(options_.direct, rays));
}

Rgb SolutionReader::reflected_radiosity_by_path(const RayHit& hit, PathSampler sampler) const {
  const World& world = *state_->world;
  const SurfacePoint y = surface_point(world.geometry, hit);
  return reflectance_at(world.scene, world.geometry, hit.triangle, hit.barycentric) *
         paths_.irradiance_by_one_path(y.position, y.normal, sampler,
                                       [&](const RayHit& next) -> std::optional<Rgb> {
                                         const ElementId leaf = state_->tree.leaf_hit(next);
                                         if (leaf.valid() && is_near(next.distance, leaf))
                                           return std::nullopt;
                                         return reflected_radiosity(next, leaf);
                                       });
}

Reading SolutionReader::read(const ReadingPoint& point) const {
  if (indirect_ && point.triangle.valid()) return read_from_cell(point);
  Reading reading;
  reading.direct = direct(point.position, point.normal);
  if (!point.direct_only) reading.indirect = gather(point);
  return reading;
}

ElementId SolutionReader::leaf_at(const ReadingPoint& point) const {
  RayHit there;
  there.triangle = point.triangle;
  there.front =
      glm::dot(point.normal, state_->world->geometry.scaled_normal(point.triangle)) >= 0.f;
  return state_->tree.find_leaf(state_->surfaces->side_hit(there), point.position);
}

bool SolutionReader::is_covered(const ReadingPoint& point) const {
  const RayScene& rays = state_->world->rays;
  const Vec3 from = rays.lift(point.position, point.normal);
  const auto hit = rays.closest_hit(from, point.normal, kInfinity, hash(point.triangle.value));
  return hit && !state_->tree.leaf_hit(*hit).valid();
}

std::vector<std::uint8_t> SolutionReader::covered(std::span<const ReadingPoint> points) const {
  std::vector<std::uint8_t> covered(points.size());
  parallel_for(points.size(), 64, [&](std::size_t i) { covered[i] = is_covered(points[i]); });
  return covered;
}

bool SolutionReader::matters_to_nobody(const ReadingPoint& point) const {
  if (state_->importance.empty() || !point.triangle.valid()) return false;
  const ElementId leaf = leaf_at(point);
  return leaf.valid() && state_->importance[leaf] < kNegligibleImportance;
}

Reading SolutionReader::read_from_cell(const ReadingPoint& point) const {
  const ElementId leaf = leaf_at(point);
  if (!leaf.valid()) return {};
  // Refined links bring the light of emitters, too, and do not tell it from the rest.
  if (state_->sampled[leaf] == 0) return of_cell(point);
  Reading reading;
  reading.direct = direct(point.position, point.normal);
  if (point.direct_only) return reading;
  reading.indirect = indirect_->at(leaf, point.position);
  const float times = times_the_rays(reading.indirect);
  if (times > kBrightForCells)
    reading.indirect = gather(point.position, point.normal,
                              static_cast<int>(times * static_cast<float>(kRaysInsteadOfCells)));
  return reading;
}

Reading SolutionReader::of_cell(const ReadingPoint& point) const {
  if (!point.triangle.valid()) return read(point);
  const ElementId leaf = leaf_at(point);
  if (!leaf.valid()) return {};
  const Rgb direct = state_->given_light[leaf];
  return {direct, glm::max(irradiance_.at(leaf, point.position) - direct, Rgb(0.f))};
}

std::vector<Reading> SolutionReader::operator()(std::span<const ReadingPoint> points,
                                                const Progress& progress) const {
  std::vector<Reading> readings(points.size());
  parallel_for(points.size(), 16, [&](std::size_t i) {
    const bool at_once = progress.cancelled() || matters_to_nobody(points[i]);
    readings[i] = at_once ? of_cell(points[i]) : read(points[i]);
  });
  return readings;
}

std::vector<Reading> SolutionReader::indirect(std::span<const ReadingPoint> points,
                                              const Progress& progress) const {
  std::vector<Reading> readings(points.size());
  parallel_for(points.size(), 16, [&](std::size_t i) {
    if (points[i].direct_only) return;
    const bool at_once = progress.cancelled() || matters_to_nobody(points[i]);
    readings[i].indirect = at_once ? of_cell(points[i]).indirect : gather(points[i]);
  });
  return readings;
}

}  // namespace halflight
