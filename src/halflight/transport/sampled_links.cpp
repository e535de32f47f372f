#include "halflight/transport/sampled_links.h"

#include <algorithm>
#include <optional>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/punctual_light.h"

namespace halflight {
namespace {

constexpr float kLeastShareOfRays = 0.125f;  // of a small receiver
constexpr float kMostShareOfArea = 8.f;      // of a large one
constexpr float kMostTimesRays = 16.f;       // of a bright one

// Rays at a receiver in proportion to the root of its area and to its light make the error of the
// whole scene least (Neyman 1934).
int by_area_and_light(int rays, const ElementTree& tree, ElementId receiver,
                      const SampledLinkOptions& options) {
  float share = 1.f;
  if (options.area_of_all_rays > 0.f)
    share = std::min(std::sqrt(tree[receiver].area / options.area_of_all_rays), kMostShareOfArea);
  if (options.brightness) share *= std::max(1.f, options.brightness(receiver));
  share =
      std::min(std::max(kLeastShareOfRays, share), kMostTimesRays);  // also of what is no number
  return std::max(1, static_cast<int>(share * static_cast<float>(rays)));
}

// Angle between neighbours among n rays that share a solid angle.
float between_rays(float solid_angle, int n) {
  return std::sqrt(solid_angle / static_cast<float>(n));
}

// Adds what one of n rays of the receiver has met.
struct RayTally {
  std::vector<ReceiverLink>& links;
  std::size_t first = links.size();
  int buried = 0;

  void add(const ElementTree& tree, const IdVector<ElementId, float>& opacity, ElementId receiver,
           const RayHit& hit, float weight) {
    const ElementId source = tree.leaf_hit(hit);
    if (!source.valid()) {
      // A side that never sees light: the ray began in a place covered by a closed body.
      ++buried;
      return;
    }
    // A cell of which no sample was opaque: what was hit is too little of it to send any light.
    if (!(opacity[source] > 0.f)) return;
    links.push_back({receiver, {source, weight / opacity[source], 0.f, {}}});
  }
  // The rays that began in the open stand for the covered ones too: the receiver's light is that
  // of its visible part.
  void make_up_for_buried(int n) {
    if (buried == 0 || buried == n) return;
    const float scale = static_cast<float>(n) / static_cast<float>(n - buried);
    for (std::size_t i = first; i < links.size(); ++i) links[i].link.weight *= scale;
  }
};

// Cosine-distributed rays from points spread over the cell: each hit carries 1 / n of the
// hemisphere.
void sample_cell(const ElementTree& tree, const RayScene& rays,
                 const IdVector<ElementId, float>& opacity, ElementId cell, int n,
                 std::vector<ReceiverLink>& links) {
  const Vec3 normal = tree.normal(cell);
  const Frame frame = Frame::from_normal(normal);
  const Vec2 shift_x = random_shift(hash(cell.value, 23)),
             shift_w = random_shift(hash(cell.value, 29));
  RayTally tally{links};
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(n); ++k) {
    // Points and directions walk through their sequences with different strides.
    const Vec3 x = tree.sample(cell, companion_sequence(k, shift_x)).position;
    const Vec3 w = frame.to_world(cosine_hemisphere(r2_sequence(k, shift_w)));
    const auto hit = rays.closest_hit(rays.lift(x, normal), w, kInfinity, hash(cell.value, k));
    if (hit) tally.add(tree, opacity, cell, *hit, 1.f / static_cast<float>(n));
  }
  tally.make_up_for_buried(n);
}

// The sides in a cluster, to choose from by direction.
class FacingSides {
 public:
  FacingSides(const ElementTree& tree, ElementId cluster) : tree_(tree) {
    std::vector<ElementId> open{cluster};
    while (!open.empty()) {
      const ElementId e = open.back();
      open.pop_back();
      if (!tree[e].is_cluster())
        sides_.push_back({tree[e].area * tree.normal(e), e});
      else
        for (const ElementId child : tree[e].children()) open.push_back(child);
    }
    facing_.resize(sides_.size());
  }

  struct Point {
    Vec3 position{0.f};
    Vec3 normal{0.f};
  };
  // With density area * cosine to w; none where no side faces it.
  std::optional<Point> choose(const Vec3& w, std::uint64_t seed) {
    float total = 0.f;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      total += std::max(0.f, glm::dot(sides_[i].area, w));
      facing_[i] = total;
    }
    if (!(total > 0.f)) return std::nullopt;
    const float wanted = to_unit_float(hash(seed, 3)) * total;
    const auto chosen = std::upper_bound(facing_.begin(), facing_.end() - 1, wanted);
    const ElementId side = sides_[static_cast<std::size_t>(chosen - facing_.begin())].element;
    return Point{tree_.sample(side, random_shift(seed)).position, tree_.normal(side)};
  }

 private:
  struct Side {
    Vec3 area;  // times the normal
    ElementId element;
  };
  const ElementTree& tree_;
  std::vector<Side> sides_;
  std::vector<float> facing_;  // areas times cosines, added up
};

// What a mean over all cells of a cluster that face w becomes where the cluster is seen from there,
// or where it is hidden.
float concentration(const ClusterVisibility* inside, ElementId cluster, const Vec3& w,
                    bool hidden) {
  return inside && inside->knows(cluster) ? inside->concentration(cluster, w, hidden) : 1.f;
}

// Uniform directions, each seen from a cell that faces it: radiance B / pi over 4 pi / n.
void sample_cluster(const ElementTree& tree, const RayScene& rays,
                    const IdVector<ElementId, float>& opacity, ElementId cluster,
                    const SampledLinkOptions& options, std::vector<ReceiverLink>& links) {
  const int n = rays_of(tree, cluster, options);
  const Vec2 shift = random_shift(hash(cluster.value, 31));
  FacingSides sides(tree, cluster);
  RayTally tally{links};
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(n); ++k) {
    const Vec3 w = uniform_sphere(r2_sequence(k, shift));
    const std::uint64_t seed = hash(cluster.value, k);
    const auto x = sides.choose(w, seed);
    if (!x) continue;
    const auto hit = rays.closest_hit(rays.lift(x->position, x->normal), w, kInfinity, seed);
    if (!hit) continue;
    const std::size_t before = links.size();
    tally.add(tree, opacity, cluster, *hit, 4.f / static_cast<float>(n));
    if (links.size() == before) continue;
    Link& link = links.back().link;
    link.direction = PackedDirection(w);
    link.weight *= concentration(options.inside, cluster, w, tree.contains(cluster, link.source));
  }
  tally.make_up_for_buried(n);
}

}  // namespace

DirectLight sample_direct_light(const ElementTree& tree, const Visibility& visibility,
                                const EmitterTree& emitters, ElementId cluster,
                                const SampledLinkOptions& options) {
  const World& world = visibility.world();
  const Element& c = tree[cluster];
  const float s = options.feature_size;
  const auto n = static_cast<std::uint32_t>(
      by_area_and_light(options.shadow_rays_per_cluster, tree, cluster, options));
  const float share = 1.f / static_cast<float>(n);
  DirectLight light;
  const auto add = [&](std::vector<Arrival>& to, const Vec3& w, const Rgb& facing) {
    if (max_component(facing) > 0.f)
      to.push_back({w, facing * concentration(options.inside, cluster, w, false)});
  };
  FacingSides sides(tree, cluster);
  // A point of the cluster that faces the direction, lifted off its side.
  const auto facing_point = [&](const Vec3& w, std::uint64_t seed) -> std::optional<Vec3> {
    const auto x = sides.choose(w, seed);
    if (!x) return std::nullopt;
    return world.rays.lift(x->position, x->normal);
  };
  const Vec2 shift = random_shift(hash(cluster.value, 37));
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint64_t seed = hash(cluster.value, k, 41);
    const float choice = (static_cast<float>(k) + to_unit_float(seed)) * share;
    const auto y =
        emitters.choose(c.center(), 0.5f * c.diameter(), Vec3(r2_sequence(k, shift), choice));
    if (!y) break;
    const auto x = facing_point(glm::normalize(y->position - c.center()), seed);
    if (!x) continue;
    const Vec3 between = y->position - *x;
    const float squared = glm::dot(between, between);
    const Vec3 w = between / std::sqrt(squared);
    const float cosine = -glm::dot(y->normal, w);
    if (!(cosine > 0.f)) continue;
    add(light.of_emitters, w,
        share * cosine / squared * emitters.seen(y->emitter, *x, y->position, s) * y->power);
  }
  for (const PunctualLight& lamp : world.geometry.lights) {
    const Vec3 w = direction_to(lamp, c.center());
    const auto x = facing_point(w, hash(cluster.value, 43));
    if (!x) continue;
    const float visible = lamp.kind == Light::Kind::directional
                              ? visibility.transmittance_to_sky(*x, w, s, 0.f)
                              : visibility.transmittance({*x, lamp.position, s, 0.f});
    add(light.from_outside, w, visible * facing_irradiance(lamp, *x));
  }
  if (max_component(world.scene.sky) > 0.f)
    for (std::uint32_t k = 0; k < n; ++k) {
      const Vec3 w = uniform_sphere(r2_sequence(k, shift));
      const auto x = facing_point(w, hash(cluster.value, k, 47));
      if (!x) continue;
      const float angle = between_rays(4.f * kPi, static_cast<int>(n));
      add(light.from_outside, w,
          4.f * kPi * share * visibility.transmittance_to_sky(*x, w, s, angle) * world.scene.sky);
    }
  return light;
}

std::vector<ElementId> choose_receivers(const ElementTree& tree, std::vector<ElementId> below,
                                        const IdVector<ElementId, float>& largest_diameter) {
  return cut_into_receivers(tree, std::move(below), [&](ElementId cluster) {
    return tree[cluster].diameter() <= largest_diameter[cluster];
  });
}

int rays_of(const ElementTree& tree, ElementId receiver, const SampledLinkOptions& options) {
  const int all = tree[receiver].is_cluster() ? options.rays_per_cluster : options.rays_per_cell;
  return by_area_and_light(all, tree, receiver, options);
}

std::vector<ReceiverLink> sample_links(const ElementTree& tree, const RayScene& rays,
                                       const IdVector<ElementId, float>& opacity,
                                       const std::vector<ElementId>& receivers,
                                       const SampledLinkOptions& options) {
  return parallel_collect<ReceiverLink>(
      receivers.size(), 64, [&](std::size_t i, std::vector<ReceiverLink>& links) {
        const ElementId e = receivers[i];
        if (tree[e].is_cluster())
          sample_cluster(tree, rays, opacity, e, options, links);
        else
          sample_cell(tree, rays, opacity, e, rays_of(tree, e, options), links);
      });
}

}  // namespace halflight
