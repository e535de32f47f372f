#include "halflight/transport/sampled_links.h"

#include <algorithm>
#include <optional>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/punctual_light.h"
#include "halflight/transport/outer_light.h"

namespace halflight {
namespace {

constexpr float kLeastShareOfRays = 0.03125f;  // of a small receiver
constexpr float kMostShareOfArea = 8.f;        // of a large one
constexpr float kMostTimesRays = 16.f;         // of a bright one

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

// Cosine-distributed rays from points spread over the cell.
void shoot_from_cell(const ElementTree& tree, const RayScene& rays, ElementId cell, int n,
                     std::vector<RayQuery>& queries) {
  const Vec3 normal = tree.normal(cell);
  const Frame frame = Frame::from_normal(normal);
  const Vec2 shift_x = random_shift(hash(cell.value, 23)),
             shift_w = random_shift(hash(cell.value, 29));
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(n); ++k) {
    // Points and directions walk through their sequences with different strides.
    const Vec3 x = tree.sample(cell, companion_sequence(k, shift_x)).position;
    const Vec3 w = frame.to_world(cosine_hemisphere(r2_sequence(k, shift_w)));
    queries.push_back({rays.lift(x, normal), w, hash(cell.value, k)});
  }
}

// The sides in a cluster, to choose from by direction.
class FacingSides {
 public:
  FacingSides(const ElementTree& tree, ElementId cluster) : tree_(tree), cluster_(cluster) {}

  struct Point {
    Vec3 position{0.f};
    Vec3 normal{0.f};
  };
  // With density area * cosine to w; none where no side faces it.
  std::optional<Point> choose(const Vec3& w, std::uint64_t seed) {
    ElementId side = try_some(w, seed);
    if (!side.valid()) side = choose_among_all(w, seed);
    if (!side.valid()) return std::nullopt;
    return Point{tree_.sample(side, random_shift(seed)).position, tree_.normal(side)};
  }

 private:
  // Most clusters have many sides that do: rejection finds one soon, or none.
  ElementId try_some(const Vec3& w, std::uint64_t seed) const {
    constexpr std::uint32_t kTries = 8;
    for (std::uint32_t attempt = 0; attempt < kTries; ++attempt) {
      const ElementId side = side_at(to_unit_float(hash(seed, attempt, 1)));
      if (to_unit_float(hash(seed, attempt, 2)) < glm::dot(tree_.normal(side), w)) return side;
    }
    return {};
  }

  // Of all area of the cluster, in the order of its children.
  ElementId side_at(float share) const {
    ElementId at = cluster_;
    while (tree_[at].is_cluster()) {
      float left = share * tree_[at].area;
      ElementId chosen = tree_[at].children()[0];
      for (const ElementId child : tree_[at].children()) {
        chosen = child;
        if (left < tree_[child].area) break;
        left -= tree_[child].area;
      }
      share = std::min(left / tree_[chosen].area, 0.999999f);
      at = chosen;
    }
    return at;
  }

  ElementId choose_among_all(const Vec3& w, std::uint64_t seed) {
    if (sides_.empty())
      for_all_below(tree_, cluster_, [&](ElementId e) {
        if (!tree_[e].is_cluster() && tree_[tree_[e].parent].is_cluster()) sides_.push_back(e);
      });
    float total = 0.f;
    facing_.clear();
    for (const ElementId side : sides_) {
      total += tree_[side].area * std::max(0.f, glm::dot(tree_.normal(side), w));
      facing_.push_back(total);
    }
    if (!(total > 0.f)) return {};
    const float wanted = to_unit_float(hash(seed, 3)) * total;
    const auto chosen = std::upper_bound(facing_.begin(), facing_.end() - 1, wanted);
    return sides_[static_cast<std::size_t>(chosen - facing_.begin())];
  }

  const ElementTree& tree_;
  ElementId cluster_;
  std::vector<ElementId> sides_;  // empty: not asked for yet
  std::vector<float> facing_;     // areas times cosines, added up
};

// What a mean over all cells of a cluster that face w becomes where the cluster is seen from there,
// or where it is hidden.
float concentration(const ClusterVisibility* inside, ElementId cluster, const Vec3& w,
                    bool hidden) {
  return inside && inside->knows(cluster) ? inside->concentration(cluster, w, hidden) : 1.f;
}

// Uniform directions, each seen from a side that faces it.
void shoot_from_cluster(const ElementTree& tree, const RayScene& rays, ElementId cluster, int n,
                        std::vector<RayQuery>& queries) {
  const Vec2 shift = random_shift(hash(cluster.value, 31));
  FacingSides sides(tree, cluster);
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(n); ++k) {
    const Vec3 w = uniform_sphere(r2_sequence(k, shift));
    const std::uint64_t seed = hash(cluster.value, k);
    const auto x = sides.choose(w, seed);
    if (x) queries.push_back({rays.lift(x->position, x->normal), w, seed});
  }
}

// What a receiver is to shoot: n rays, fewer where no side faces their way.
struct Shots {
  ElementId receiver;
  int n = 0;
  std::size_t first = 0, last = 0;  // of the queries of its block
};

// Appends the links of a receiver's rays. Those of a cell each carry 1 / n of the hemisphere; those
// of a cluster radiance B / pi over 4 pi / n.
void link_hits(const ElementTree& tree, const IdVector<ElementId, float>& opacity,
               const ClusterVisibility* inside, const Shots& shots,
               std::span<const RayQuery> queries, std::span<const std::optional<RayHit>> hits,
               std::vector<ReceiverLink>& links) {
  const auto n = static_cast<float>(shots.n);
  const bool is_cluster = tree[shots.receiver].is_cluster();
  const std::size_t first = links.size();
  int buried = 0;
  for (std::size_t k = shots.first; k < shots.last; ++k) {
    if (!hits[k]) continue;
    const ElementId source = tree.leaf_hit(*hits[k]);
    if (!source.valid()) {
      // A side that never sees light: the ray began in a place covered by a closed body.
      ++buried;
      continue;
    }
    // A cell of which no sample was opaque: what was hit is too little of it to send any light.
    if (!(opacity[source] > 0.f)) continue;
    Link link{source, (is_cluster ? 4.f : 1.f) / (n * opacity[source]), 0.f, {}};
    if (is_cluster) {
      const Vec3& w = queries[k].direction;
      link.direction = PackedDirection(w);
      const bool hidden = tree.contains(shots.receiver, source);
      link.weight *= concentration(inside, shots.receiver, w, hidden);
    }
    links.push_back({shots.receiver, link});
  }
  // The rays that began in the open stand for the covered ones too: the receiver's light is that
  // of its visible part.
  const float open = n - static_cast<float>(buried);
  if (buried == 0 || !(open > 0.f)) return;
  for (std::size_t i = first; i < links.size(); ++i) links[i].link.weight *= n / open;
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
    if (!y) continue;
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
    const float visible = punctual_visibility(visibility, lamp, *x, w, s);
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
  constexpr std::size_t kTogether = 256;  // neighbours, whose rays meet the same places
  return parallel_collect_blocks<ReceiverLink>(
      receivers.size(), kTogether,
      [&](std::size_t first, std::size_t last, std::vector<ReceiverLink>& links) {
        std::vector<RayQuery> queries;
        std::vector<Shots> all_shots;
        for (std::size_t i = first; i < last; ++i) {
          Shots shots{receivers[i], rays_of(tree, receivers[i], options), queries.size()};
          if (tree[shots.receiver].is_cluster())
            shoot_from_cluster(tree, rays, shots.receiver, shots.n, queries);
          else
            shoot_from_cell(tree, rays, shots.receiver, shots.n, queries);
          shots.last = queries.size();
          all_shots.push_back(shots);
        }
        const std::vector<std::optional<RayHit>> hits = rays.closest_hits(queries);
        for (const Shots& shots : all_shots)
          link_hits(tree, opacity, options.inside, shots, queries, hits, links);
      });
}

}  // namespace halflight
