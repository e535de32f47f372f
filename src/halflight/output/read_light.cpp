#include "halflight/output/read_light.h"

#include "halflight/base/parallel.h"
#include "halflight/rays/adaptive_hemisphere.h"
#include "halflight/rays/sampling.h"
#include "halflight/solve/importance.h"
#include "halflight/transport/outer_light.h"

namespace halflight {

namespace {

constexpr int kLeastSkyRays = 64;

// A surface this much brighter than the scene's mean radiosity is read like an emitter.
constexpr float kBright = 5.f;
constexpr float kFinestEdge = 1e-3f;  // of the scene's diagonal
constexpr float kErrorOfPlainReading = 0.05f;
constexpr float kLeastReading = 1.f / 32.f, kMostReading = 8.f;
// Of an emitter that a sensor sees through a small opening, few rays would meet anything.
constexpr int kSensorShadowRays = 32;
constexpr int kSensorPenumbraRays = 1024;
constexpr int kMostBounces = 4;  // of gather rays that end nearby

struct ReflectedPower {
  IdVector<SideId, double> of_sides;  // W, average of the channels
  double mean = 0.0;                  // per area of the whole scene, W/m2
};

ReflectedPower reflected_power(const SolverState& state) {
  ReflectedPower power;
  power.of_sides = IdVector<SideId, double>(2 * state.surfaces->surfaces.size(), 0.0);
  double sum = 0.0, area = 0.0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    const Element& cell = state.tree[e];
    if (!cell.is_leaf_cell()) continue;
    const float reflected = average(state.reflectance[e] * state.irradiance[e]);
    if (!(reflected > 0.f)) continue;
    power.of_sides[cell.side] += static_cast<double>(cell.area * reflected);
    sum += static_cast<double>(cell.area * reflected);
    area += static_cast<double>(cell.area);
  }
  power.mean = area > 0.0 ? sum / area : 0.0;
  return power;
}

// Surfaces that reflect much more light than others.
std::vector<EmittingSide> find_bright_reflectors(const SolverState& state,
                                                 const RadianceAt& reflected_radiance,
                                                 IdVector<SideId, std::uint8_t>& is_bright) {
  const ReflectedPower power = reflected_power(state);
  is_bright = IdVector<SideId, std::uint8_t>(power.of_sides.size(), 0);
  std::vector<EmittingSide> bright;
  for (std::size_t i = 0; i < is_bright.size(); ++i) {
    const SideId side(i);
    const ElementId cell = state.tree.side_root(side);
    if (!cell.valid() ||
        !(power.of_sides[side] > kBright * power.mean * static_cast<double>(state.tree[cell].area)))
      continue;
    is_bright[side] = 1;
    const Surface& s = (*state.surfaces)[side];
    for (std::uint32_t k = 0; k < s.triangle_count; ++k) {
      EmittingSide emitter;
      emitter.triangle = state.surfaces->triangles[s.first_triangle + k];
      emitter.back = is_back(side);
      emitter.varies = !state.tree[cell].is_leaf();
      emitter.radiance = emitter.varies ? mean_radiance(emitter, reflected_radiance)
                                        : state.reflectance[cell] * state.irradiance[cell] / kPi;
      emitter.power = average(emitter.radiance) * state.world->geometry.area(emitter.triangle);
      if (emitter.power > 0.f) bright.push_back(emitter);
    }
  }
  return bright;
}

ReadOptions with_feature_size(ReadOptions options, float feature_size) {
  options.direct.feature_size = feature_size;
  return options;
}

// In [0, 1), for one of so many rays that fill the hemisphere: of any few neighbours on the disc
// the choices are spread evenly (a lattice of the plastic number's powers, as in r2_sequence).
float choice_of(const Vec3& w, float rays, std::uint64_t seed) {
  const Vec2 cell = (0.5f * std::sqrt(rays)) * Vec2(w);
  const float x = random_shift(seed).x + 0.7548777f * cell.x + 0.5698403f * cell.y;
  return std::min(x - std::floor(x), 0.999999f);
}

// Bright surfaces are a part of what is gathered, and worth no more rays than the rest.
DirectLightOptions bright_options(DirectLightOptions options, int gather_rays) {
  options.shadow_rays = std::clamp(gather_rays / 8, 1, options.shadow_rays);
  options.penumbra_rays = std::clamp(gather_rays / 2, 1, options.penumbra_rays);
  options.largest_group_share =
      std::max(options.largest_group_share, 1.f / static_cast<float>(gather_rays));
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
  return 0.5f * std::min(state.options.feature_size, smallest);
}

ReadOptions sensor_reading(const SolverState& state) {
  const float more =
      std::clamp(kErrorOfPlainReading / state.options.error, kLeastReading, kMostReading);
  const auto rays = [&](int plain, int least) {
    return std::max(least, static_cast<int>(more * static_cast<float>(plain)));
  };
  ReadOptions options;
  options.gather_rays = rays(options.gather_rays, 1);
  options.direct.shadow_rays = kSensorShadowRays;
  options.direct.penumbra_rays = std::min(rays(kSensorPenumbraRays, 32), kSensorPenumbraRays);
  return options;
}

SolutionReader::SolutionReader(const SolverState& state, const ReadOptions& options)
    : state_(&state),
      options_(with_feature_size(options, state.options.feature_size)),
      emitters_(*state.visibility, find_emitters(*state.world)),
      irradiance_(state),
      bright_(*state.visibility, find_bright_reflectors(state, reflected_radiance(), is_bright_),
              reflected_radiance()) {
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

RadianceAt SolutionReader::reflected_radiance() const {
  return [this](const EmittingSide& e, Vec2 barycentric) {
    const RayHit there{.triangle = e.triangle, .barycentric = barycentric, .front = !e.back};
    return reflected_radiosity(there) / kPi;
  };
}

Rgb SolutionReader::gather(const Vec3& x, const Vec3& n) const {
  // Points in the air lie in no cell.
  const int rays = options_.gather_rays > 0 ? options_.gather_rays : kMeshReading.gather_rays;
  return gather(x, n, {.rays = rays}) +
         bright_.irradiance(x, n, bright_options(options_.direct, rays));
}

Rgb SolutionReader::gather(const Vec3& x, const Vec3& n, const GatherRays& gathering) const {
  const World& world = *state_->world;
  const Frame frame = Frame::from_normal(n);
  const Vec3 from = world.rays.lift(x, n);
  std::uint32_t index = 0;
  return adaptive_cosine_mean(
      gathering.rays, gathering.shift, [&](const Vec3& w, float rays) -> SeenLight {
        const std::uint64_t seed = hash(gathering.seed, index++);
        const auto hit = world.rays.closest_hit(from, frame.to_world(w), kInfinity, seed);
        if (!hit || is_bright_[state_->surfaces->side_hit(*hit)]) return Rgb(0.f);
        const ElementId leaf = state_->tree.leaf_hit(*hit);
        const bool near = leaf.valid() && gathering.bounces < kMostBounces &&
                          hit->distance < options_.near_hits * state_->tree.cell_size(leaf);
        const Rgb of_cell = reflected_radiosity(*hit, leaf);
        if (!near) return of_cell;
        const float choice = choice_of(w, rays, gathering.seed);
        return {reflected_radiosity_by_path(*hit, choice, seed, gathering.bounces), of_cell};
      });
}

Rgb SolutionReader::reflected_radiosity_by_path(const RayHit& hit, float choice, std::uint64_t seed,
                                                int bounces) const {
  const World& world = *state_->world;
  const Vec3 y = hit_position(world.geometry, hit), n = hit_normal(world.geometry, hit);
  const float s = options_.direct.feature_size;
  const Vec2 shift = random_shift(seed);
  const Rgb irradiance = emitters_.irradiance_by_one_ray(y, n, choice, shift, s) +
                         bright_.irradiance_by_one_ray(y, n, choice, shift, s) +
                         punctual_irradiance(*state_->visibility, y, n, s) +
                         sky_irradiance(*state_->visibility, y, n, 1, shift, s) +
                         gather(y, n, {1, random_shift(hash(seed, 1)), seed, bounces + 1});
  return reflectance_at(world.scene, world.geometry, hit.triangle, hit.barycentric) * irradiance;
}

Reading SolutionReader::read(const ReadingPoint& point) const {
  if (indirect_ && point.triangle.valid()) return read_from_cell(point);
  Reading reading;
  reading.direct = direct(point.position, point.normal);
  if (!point.direct_only) reading.indirect = gather(point.position, point.normal);
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
  if (!point.direct_only) reading.indirect = indirect_->at(leaf, point.position);
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
    readings[i].indirect =
        at_once ? of_cell(points[i]).indirect : gather(points[i].position, points[i].normal);
  });
  return readings;
}

}  // namespace halflight
