#include "halflight/solve/cells.h"

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"
#include "halflight/solve/memory.h"
#include "halflight/transport/outer_light.h"

namespace halflight {
namespace {

constexpr std::uint32_t kTextureSamples = 8;
constexpr std::uint32_t kPointsOfCell = 4;
// Cells that receive much get more points: a share of all received power for each.
constexpr double kShareOfPoint = 1e-4;
constexpr std::uint32_t kMostPoints = 128;
// Of a point that things stand close above. The less it counts, the more do neighbours in the nook
// see too much: energy is made.
constexpr float kWeightOfHidden = 0.3f;
constexpr int kSkyRays = 16;  // of each point

constexpr DirectLightOptions kCellDirectLight{
    .shadow_rays = 8, .penumbra_rays = 8, .largest_group_share = 0.05f, .smallest_angle = 0.01f};
// Cells that get less than a point's share, and are not much brighter than others.
constexpr DirectLightOptions kSlightDirectLight{
    .shadow_rays = 2, .penumbra_rays = 2, .largest_group_share = 0.2f, .smallest_angle = 0.01f};
constexpr double kBright = 3.0;                 // in mean irradiances
constexpr float kErrorOfAllShadowRays = 0.05f;  // larger ones take fewer, in proportion
constexpr int kFewestShadowRays = 2;

// Smaller errors take more rays for each receiver, in proportion; larger ones fewer.
constexpr float kErrorOfPlainSampling = 0.05f;
constexpr float kLeastSampling = 0.125f, kMostSampling = 8.f;
// SampledLinkOptions::area_of_all_rays of the scene's.
constexpr float kAreaOfAllRays = 1.f / 4096.f;
constexpr float kLargestReceiver = 1.f / 16.f;  // of the scene's diagonal

constexpr float kFinestCell = 1e-3f;  // of the scene's diagonal, whatever the feature size

// Streams of samples: to decide with, and to keep.
constexpr std::uint64_t kPilot = 1, kKept = 2;

struct GivenLight {
  Rgb mean{0.f};
  Rgb outer{0.f};     // by punctual lights and the sky, on all of the cell
  float share = 1.f;  // SolverState::given_share
  float deviation = 0.f;
};

// Covered by a closed body: straight above lies a side that never sees light.
bool is_buried(const SolverState& state, const Vec3& x, const Vec3& n, std::uint64_t seed) {
  const RayScene& rays = state.world->rays;
  const auto hit = rays.closest_hit(rays.lift(x, n), n, kInfinity, seed);
  return hit && !state.tree.leaf_hit(*hit).valid();
}

// Whether a place is seen from farther away than its cell is large, by one ray. Seen from there a
// cell looks like the part of it that lies open, which gets more light than what things stand on.
bool lies_open(const SolverState& state, ElementId cell, const Vec3& x, const Vec3& n,
               std::uint64_t seed) {
  const RayScene& rays = state.world->rays;
  const Vec3 w = Frame::from_normal(n).to_world(cosine_hemisphere(random_shift(seed)));
  return !rays.closest_hit(rays.lift(x, n), w, state.tree.cell_size(cell), hash(seed));
}

double received_power(const SolverState& state, ElementId cell) {
  return static_cast<double>(state.tree[cell].area) *
         static_cast<double>(average(state.irradiance[cell]));
}

// By what has been known before, so that the number has nothing to do with what is found.
std::uint32_t points_of(const SolverState& state, ElementId cell, double total_power) {
  const bool whole_and_small = state.tree.cell_size(cell) < 2.f * smallest_cell(state, cell);
  const double share = received_power(state, cell) / std::max(total_power, 1e-30);
  const double points = std::min(share / kShareOfPoint, double{kMostPoints});
  return std::max(static_cast<std::uint32_t>(points), whole_and_small ? 1u : kPointsOfCell);
}

// Where a cell's light is noisy, little is lost if it is one of many like it. Not in front of an
// emitter: few rays say too little of what may come from there.
bool is_slight(const SolverState& state, ElementId cell, double total_power) {
  const double bright =
      kBright * total_power / static_cast<double>(state.tree[state.tree.root()].area);
  if (received_power(state, cell) >= kShareOfPoint * total_power ||
      static_cast<double>(average(state.irradiance[cell])) >= bright)
    return false;
  return !state.emitters || static_cast<double>(state.emitters->unoccluded_irradiance(
                                state.tree[cell].center(), state.tree.normal(cell))) <= bright;
}

DirectLightOptions cell_direct_light(const SolverState& state, ElementId cell, double total_power) {
  DirectLightOptions options = kCellDirectLight;
  if (is_slight(state, cell, total_power)) {
    options = kSlightDirectLight;
    const float share = std::min(1.f, kErrorOfAllShadowRays / aimed_error(state));
    const auto rays = static_cast<int>(share * static_cast<float>(options.shadow_rays));
    options.shadow_rays = std::max(kFewestShadowRays, rays);
    options.penumbra_rays = options.shadow_rays;
  }
  options.feature_size = state.feature_sizes[cell];
  return options;
}

// Of the part that is not covered; of what is kept, of the part that lies open. Light from emitters
// is left to refined links.
GivenLight sample_given_light(const SolverState& state, ElementId cell, std::uint32_t samples,
                              std::uint64_t stream, const DirectLightOptions& direct) {
  const EmitterTree* emitters = state.sampled[cell] != 0 ? state.emitters.get() : nullptr;
  const Vec3 n = state.tree.normal(cell);
  const float s = direct.feature_size;
  // All points of a pilot look at the same places: what differs then lies in the points.
  const auto samples_of = [&](std::uint32_t k) { return hash(stream, stream == kPilot ? 0 : k); };
  GivenLight result;
  float sum = 0.f, squares = 0.f;
  const Vec2 shift = random_shift(hash(cell.value, stream, 11));
  float count = 0.f, weights = 0.f;
  for (std::uint32_t k = 0; k < samples; ++k) {
    const Vec3 x = state.tree.sample(cell, r2_sequence(k, shift)).position;
    if (is_buried(state, x, n, hash(cell.value, k, stream, 17))) continue;
    const bool open = stream == kPilot || lies_open(state, cell, x, n, hash(cell.value, k, 19));
    const float weight = open ? 1.f : kWeightOfHidden;
    count += 1.f;
    weights += weight;
    Rgb e = punctual_irradiance(*state.visibility, x, n, s) +
            sky_irradiance(*state.visibility, x, n, kSkyRays,
                           random_shift(hash(cell.value, k, stream)), s);
    result.outer += e;
    if (emitters)
      e += emitters->irradiance(x, n, direct, random_shift(hash(cell.value, samples_of(k), 13)));
    result.mean += weight * e;
    sum += average(e);
    squares += average(e) * average(e);
  }
  if (count == 0.f) return result;
  result.mean /= weights;
  result.outer /= count;
  if (average(result.mean) > 0.f) result.share = sum / count / average(result.mean);
  if (count > 1.f)
    result.deviation = std::sqrt(std::max(0.f, (squares - sum * sum / count) / (count - 1.f)));
  return result;
}

}  // namespace

double received_power(const SolverState& state) {
  return parallel_sum(state.tree.size(), 4096, 0.0, [&](std::size_t i) {
    const ElementId e(i);
    return state.tree[e].is_leaf_cell() ? received_power(state, e) : 0.0;
  });
}

float finest_cell(const SolverState& state) {
  return kFinestCell * state.world->geometry.bounds.diagonal();
}

float smallest_cell(const SolverState& state, ElementId cell) {
  return smallest_cell(state.feature_sizes[cell], finest_cell(state));
}

void evaluate_material(SolverState& state, ElementId cell) {
  const ElementTree& tree = state.tree;
  const Scene& scene = state.world->scene;
  const Geometry& g = state.world->geometry;
  const SideId side = tree[cell].side;
  const Material& m = scene.materials[tree.surfaces()[side].material];
  const bool textured = m.reflectance_texture.valid() || m.alpha_texture.valid() ||
                        (m.emits() && m.emission_texture.valid());
  const std::uint32_t samples = textured ? kTextureSamples : 1;
  float opacities = 0.f;
  Rgb reflectance(0.f), emission(0.f);
  const auto add = [&](TriangleId t, Vec2 b) {
    const float opacity = opacity_at(scene, g, t, b);
    reflectance += opacity * reflectance_at(scene, g, t, b);
    emission += opacity * emission_at(scene, g, t, b);
    opacities += opacity;
  };
  const Surface& surface = tree.surfaces()[side];
  if (!textured) add(tree.surfaces().triangles[surface.first_triangle], Vec2(0.f));
  for (std::uint32_t k = 0; textured && k < samples; ++k) {
    const CellPoint p = tree.sample(cell, r2_sequence(k));
    add(p.triangle, g.barycentric(p.triangle, p.position));
  }
  const float weight = 1.f / static_cast<float>(samples);
  state.opacity[cell] = weight * opacities;
  state.reflectance[cell] = weight * reflectance;
  state.exitance[cell] = is_back(side) && !m.double_sided ? Rgb(0.f) : kPi * weight * emission;
}

void inherit(SolverState& state, const std::vector<ElementId>& split_cells) {
  const std::size_t n = state.tree.size();
  state.opacity.resize(n);
  state.reflectance.resize(n);
  state.exitance.resize(n);
  state.given_light.resize(n);
  state.given_share.resize(n, 1.f);
  state.given_light_known.resize(n, 0);
  if (!state.outer_light.empty()) state.outer_light.resize(n);
  state.irradiance.resize(n);
  state.radiosity.resize(n);
  state.tolerance.resize(n);
  state.sampled.resize(n, 0);
  state.feature_sizes.resize(n);
  if (!state.importance.empty()) state.importance.resize(n);
  if (!state.row_limits.empty()) state.row_limits.resize(n);
  parallel_for(split_cells.size(), 64, [&](std::size_t i) {
    const ElementId parent = split_cells[i];
    for (const ElementId child : state.tree[parent].children()) {
      evaluate_material(state, child);
      state.given_light[child] = state.given_light[parent];
      state.given_share[child] = state.given_share[parent];
      // Cells that are split for the next round of sampled links do with their parent's meanwhile.
      state.given_light_known[child] =
          state.sampled[parent] != 0 ? state.given_light_known[parent] : std::uint8_t{0};
      if (!state.outer_light.empty()) state.outer_light[child] = state.outer_light[parent];
      state.irradiance[child] = state.irradiance[parent];
      state.tolerance[child] = state.tolerance[parent];
      state.sampled[child] = state.sampled[parent];
      state.feature_sizes[child] = state.feature_size_rules->of_cell(state.tree[child]);
      if (!state.importance.empty()) state.importance[child] = state.importance[parent];
      if (!state.row_limits.empty()) state.row_limits[child] = state.row_limits[parent];
      state.radiosity[child] =
          state.exitance[child] + state.reflectance[child] * state.irradiance[child];
    }
  });
}

namespace {

// All leaf cells of a side get the same.
void give_light_to_side(SolverState& state, ElementId side, const Rgb& of_emitters,
                        const Rgb& outer) {
  for_all_below(state.tree, side, [&](ElementId e) {
    if (!state.tree[e].is_leaf()) return;
    state.given_light[e] = of_emitters + outer;
    state.given_share[e] = 1.f;
    if (!state.outer_light.empty()) state.outer_light[e] = outer;
    state.given_light_known[e] = 1;
  });
}

// Light on an element as far as it is known, in means of the scene; of a cluster, of its cells by
// area.
float brightness(const SolverState& state, ElementId e, float mean_irradiance) {
  float power = 0.f, area = 0.f;
  for_all_below(state.tree, e, [&](ElementId at) {
    if (!state.tree[at].is_leaf_cell()) return;
    const float light = std::max(average(state.irradiance[at]), average(state.given_light[at]));
    power += state.tree[at].area * light;
    area += state.tree[at].area;
  });
  return area > 0.f ? power / (area * mean_irradiance) : 0.f;
}

}  // namespace

std::vector<ElementId> receivers_of(const SolverState& state, std::vector<ElementId> below) {
  const float scale = state.schedule.receiver_scale;
  return cut_into_receivers(state.tree, std::move(below), [&](ElementId cluster) {
    // One light for all is no good near an emitter.
    const bool emits = max_component(state.exitance[cluster]) > 0.f;
    return state.tree[cluster].diameter() <= (emits ? 1.f : scale) * state.receiver_sizes[cluster];
  });
}

void limit_receivers(SolverState& state, std::size_t most) {
  const ElementId root = state.tree.root();
  float& scale = state.schedule.receiver_scale;
  scale = 1.f;
  if (!(state.feature_sizes[root] > 0.f)) return;
  while (scale * state.feature_sizes[root] < kLargestReceiver * state.tree[root].diameter())
    scale *= 2.f;
  while (scale > 1.f) {
    scale *= 0.5f;
    if (receivers_of(state, {root}).size() <= most) continue;
    scale *= 2.f;
    return;
  }
}

SampledLinkOptions sampled_link_options(const SolverState& state, double received) {
  SampledLinkOptions options;
  options.inside = state.inside.get();
  const float more =
      std::clamp(kErrorOfPlainSampling / aimed_error(state), kLeastSampling, kMostSampling);
  options.rays_per_cell = static_cast<int>(more * static_cast<float>(options.rays_per_cell));
  options.rays_per_cluster = static_cast<int>(more * static_cast<float>(options.rays_per_cluster));
  options.shadow_rays_per_cluster =
      static_cast<int>(std::min(1.f, more) * static_cast<float>(options.shadow_rays_per_cluster));
  const float area = state.tree[state.tree.root()].area;
  options.area_of_all_rays = kAreaOfAllRays * area;
  if (received > 0.0)
    options.brightness = [&state, mean = static_cast<float>(received) / area](ElementId e) {
      return brightness(state, e, mean);
    };
  return options;
}

void give_light_to_clusters(SolverState& state, const std::vector<ElementId>& receivers,
                            const SampledLinkOptions& options_of_all) {
  const ClusterVisibility* inside = state.inside.get();
  parallel_for(receivers.size(), 16, [&](std::size_t i) {
    const ElementTree& tree = state.tree;
    const ElementId receiver = receivers[i];
    if (!tree[receiver].is_cluster()) return;
    SampledLinkOptions options = options_of_all;
    options.feature_size = state.feature_sizes[receiver];
    const DirectLight light =
        sample_direct_light(tree, *state.visibility, *state.emitters, receiver, options);
    if (inside && inside->knows(receiver)) {
      const auto items = inside->items(receiver);
      const std::vector<Rgb> of_emitters = hand_out(*inside, receiver, light.of_emitters);
      const std::vector<Rgb> outer = hand_out(*inside, receiver, light.from_outside);
      for (std::size_t k = 0; k < items.size(); ++k)
        give_light_to_side(state, items[k].cell, of_emitters[k], outer[k]);
      return;
    }
    const DirectionalIrradiance of_emitters = directional_irradiance(light.of_emitters);
    const DirectionalIrradiance outer = directional_irradiance(light.from_outside);
    std::vector<ElementId> open{receiver};
    while (!open.empty()) {
      const ElementId e = open.back();
      open.pop_back();
      if (!tree[e].is_cluster()) {
        const Vec3 n = tree.normal(e);
        give_light_to_side(state, e, of_emitters.irradiance(n), outer.irradiance(n));
        continue;
      }
      for (const ElementId child : tree[e].children()) open.push_back(child);
    }
  });
}

namespace {

bool wants_given_light(const SolverState& state) {
  return has_outer_light(*state.world) || state.emitters;
}

bool lacks_given_light(const SolverState& state, ElementId e) {
  return state.tree[e].is_leaf_cell() && !state.given_light_known[e];
}

void give_light_to_cells(SolverState& state, std::vector<ElementId> open,
                         float irradiance_threshold, double total_power) {
  const float scene_area = state.tree[state.tree.root()].area;
  bool may_split = true;
  while (!open.empty()) {
    std::vector<std::uint8_t> uneven(open.size());
    parallel_for(open.size(), 16, [&](std::size_t i) {
      const ElementId e = open[i];
      const DirectLightOptions direct = cell_direct_light(state, e, total_power);
      // As with links: what is kept had no say in whether to split (transport/refine.cpp).
      if (may_split && state.tree.cell_size(e) > 2.f * smallest_cell(state, e)) {
        const GivenLight pilot = sample_given_light(state, e, kPointsOfCell, kPilot, direct);
        const float error = pilot.deviation * std::sqrt(state.tree[e].area / scene_area);
        uneven[i] = error > state.tolerance[e] * irradiance_threshold;
        if (uneven[i]) return;
      }
      const GivenLight light =
          sample_given_light(state, e, points_of(state, e, total_power), kKept, direct);
      state.given_light[e] = light.mean;
      state.given_share[e] = light.share;
      if (!state.outer_light.empty()) state.outer_light[e] = light.outer;
      state.given_light_known[e] = 1;
    });
    std::vector<ElementId> split;
    for (std::size_t i = 0; i < open.size(); ++i)
      if (uneven[i]) split.push_back(open[i]);
    if (!split.empty() && state.tree.size() + 2 * split.size() > memory_room(state).elements) {
      state.schedule.short_of_memory = 1;
      may_split = false;
      open = std::move(split);
      continue;
    }
    open.clear();
    for (const ElementId e : split) {
      state.tree.split(e);
      for (const ElementId child : state.tree[e].children()) open.push_back(child);
    }
    inherit(state, split);
  }
}

}  // namespace

void update_given_light(SolverState& state, float irradiance_threshold) {
  if (!wants_given_light(state)) return;
  give_light_to_cells(state,
                      parallel_collect<ElementId>(state.tree.size(), 1 << 14,
                                                  [&](std::size_t i, std::vector<ElementId>& open) {
                                                    if (lacks_given_light(state, ElementId(i)))
                                                      open.emplace_back(i);
                                                  }),
                      irradiance_threshold, received_power(state));
}

void update_given_light(SolverState& state, float irradiance_threshold,
                        const std::vector<ElementId>& receivers, double total_power) {
  if (!wants_given_light(state)) return;
  const auto collect = [&](std::size_t i, std::vector<ElementId>& open) {
    for_all_below(state.tree, receivers[i], [&](ElementId e) {
      if (lacks_given_light(state, e)) open.push_back(e);
    });
  };
  give_light_to_cells(state, parallel_collect<ElementId>(receivers.size(), 64, collect),
                      irradiance_threshold, total_power);
}

}  // namespace halflight
