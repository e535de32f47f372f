#include "halflight/visibility/hierarchy_measures.h"

#include <chrono>
#include <cmath>
#include <functional>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"
#include "halflight/visibility/chords.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight {
namespace {

constexpr double kClassRatio = 4.0;
constexpr std::size_t kTriedClusters = 256;  // of each class
constexpr std::uint32_t kTriedChords = 128;
constexpr int kMostForeign = 64;  // surfaces of others that a chord is followed through
constexpr std::size_t kRays = 8192;
constexpr float kFeatureShare = 0.01f;
constexpr float kFlatness = 0.02f;  // of the longest side: flat boxes get a volume

// What the measures need of each cluster. Surfaces are ranked depth first, so that those below a
// cluster are a run.
struct ClusterFacts {
  Bounds3f box;
  double blocking_area = 0.0;
  std::uint32_t first = 0, last = 0;  // ranks
  int depth = 1;
};

class MeasuredTree {
 public:
  MeasuredTree(const World& world, const Surfaces& surfaces, const ClusterTree& tree)
      : surfaces_(surfaces), tree_(tree), facts_(tree.clusters.size()) {
    rank_.resize(surfaces.surfaces.size());
    blocking_.resize(surfaces.surfaces.size());
    const auto areas = blocking_areas(world.scene, world.geometry, surfaces.bodies);
    for (std::size_t t = 0; t < areas.size(); ++t)
      blocking_[surfaces.of_triangle[TriangleId(t)].value] += areas[TriangleId(t)];
    visit();
  }

  const ClusterFacts& operator[](std::size_t cluster) const { return facts_[cluster]; }
  std::size_t size() const { return facts_.size(); }
  // The space taken as a medium.
  Bounds3f volume(std::size_t cluster) const {
    return thickened(tree_.volumes.empty() ? facts_[cluster].box : tree_.volumes[cluster]);
  }
  bool holds(const ClusterFacts& cluster, SurfaceId s) const {
    return rank_[s.value] >= cluster.first && rank_[s.value] < cluster.last;
  }

 private:
  void visit() {
    struct Visit {
      std::uint32_t cluster;
      std::size_t next_child;
    };
    std::uint32_t rank = 0;
    std::vector<Visit> path{{tree_.root, 0}};
    while (!path.empty()) {
      const std::uint32_t c = path.back().cluster;
      const ClusterTree::Cluster& cluster = tree_.clusters[c];
      ClusterFacts& facts = facts_[c];
      if (path.back().next_child == 0) {
        facts.first = rank;
        for (const SurfaceId s : cluster.surfaces) {
          rank_[s.value] = rank++;
          facts.box.extend(surfaces_[s].box);
          facts.blocking_area += blocking_[s.value];
        }
      }
      if (path.back().next_child < cluster.clusters.size()) {
        path.push_back({cluster.clusters[path.back().next_child++], 0});
        continue;
      }
      facts.last = rank;
      path.pop_back();
      if (path.empty()) break;
      ClusterFacts& parent = facts_[path.back().cluster];
      parent.box.extend(facts.box);
      parent.blocking_area += facts.blocking_area;
      parent.depth = std::max(parent.depth, facts.depth + 1);
    }
  }

  const Surfaces& surfaces_;
  const ClusterTree& tree_;
  std::vector<ClusterFacts> facts_;
  std::vector<std::uint32_t> rank_;  // of surfaces
  std::vector<double> blocking_;     // of surfaces
};

double padded_volume(const Bounds3f& box, float padding) {
  const Vec3 e = box.extent() + padding;
  return static_cast<double>(e.x) * static_cast<double>(e.y) * static_cast<double>(e.z);
}

void measure_shape(const Surfaces& surfaces, const ClusterTree& tree, const MeasuredTree& facts,
                   HierarchyMeasures& measures) {
  measures.clusters = tree.clusters.size();
  measures.depth = facts[tree.root].depth;
  measures.bytes = sizeof(ClusterTree) + tree.volumes.size() * sizeof(Bounds3f);
  std::size_t members = 0;
  for (std::size_t c = 0; c < tree.clusters.size(); ++c) {
    const ClusterTree::Cluster& cluster = tree.clusters[c];
    const std::size_t fan_out = cluster.clusters.size() + cluster.surfaces.size();
    members += fan_out;
    measures.largest_fan_out = std::max(measures.largest_fan_out, fan_out);
    measures.bytes += sizeof(cluster) + cluster.clusters.capacity() * sizeof(std::uint32_t) +
                      cluster.surfaces.capacity() * sizeof(SurfaceId);
    const Bounds3f whole = tree.volumes.empty() ? facts[c].box : tree.volumes[c];
    const float padding = kFlatness * whole.longest_side();
    double filled = 0.0, sum = 0.0, squares = 0.0;
    const auto add = [&](const Bounds3f& box) {
      filled += padded_volume(box, padding);
      const double size = std::log2(std::max(static_cast<double>(box.longest_side()), 1e-12));
      sum += size;
      squares += size * size;
    };
    for (const SurfaceId s : cluster.surfaces) add(surfaces[s].box);
    for (const std::uint32_t child : cluster.clusters) add(facts[child].box);
    const double volume = padded_volume(whole, padding);
    if (volume > 0.0) measures.empty_space += std::max(0.0, 1.0 - filled / volume);
    const double n = static_cast<double>(std::max<std::size_t>(fan_out, 1));
    measures.size_spread += std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
  }
  const auto count = static_cast<double>(measures.clusters);
  measures.fan_out = static_cast<double>(members) / count;
  measures.empty_space /= count;
  measures.size_spread /= count;
}

// Whether the first of the cluster's own surfaces stops the line; those of others let it through.
bool meets_own(const World& world, const Surfaces& surfaces, const MeasuredTree& tree,
               const ClusterFacts& cluster, const VisibilityRay& chord, std::uint64_t seed) {
  const float lift = world.rays.lift_distance();
  float from = -lift;
  for (int i = 0; i < kMostForeign && from < chord.reach; ++i) {
    const auto hit = world.rays.closest_hit(chord.receiver + from * chord.direction,
                                            chord.direction, chord.reach + lift - from, seed);
    if (!hit) return false;
    if (tree.holds(cluster, surfaces.of_triangle[hit->triangle])) return true;
    from += hit->distance + lift;
  }
  return false;
}

// By the medium, less exactly.
double extinction_error(const World& world, const Surfaces& surfaces, const MeasuredTree& tree,
                        std::size_t c) {
  const Bounds3f box = tree.volume(c);
  const float kappa = extinction(static_cast<float>(tree[c].blocking_area), box);
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kTriedChords; ++i) {
    const VisibilityRay chord = random_chord(box, c, i);
    const double exact = meets_own(world, surfaces, tree, tree[c], chord, i) ? 0.0 : 1.0;
    sum += std::exp(-static_cast<double>(kappa * chord.reach)) - exact;
  }
  return sum / kTriedChords;
}

void measure_extinction(const World& world, const Surfaces& surfaces, const MeasuredTree& tree,
                        HierarchyMeasures& measures) {
  std::array<std::vector<std::size_t>, 4> classes;
  const double scene = std::max(static_cast<double>(world.geometry.bounds.diagonal()), 1e-30);
  for (std::size_t c = 0; c < tree.size(); ++c) {
    const double share = std::max(static_cast<double>(tree[c].box.diagonal()) / scene, 1e-12);
    const int k = static_cast<int>(-std::log(share) / std::log(kClassRatio));
    classes[static_cast<std::size_t>(std::clamp(k, 0, 3))].push_back(c);
  }
  for (std::size_t k = 0; k < classes.size(); ++k) {
    const std::vector<std::size_t>& all = classes[k];
    ExtinctionQuality& quality = measures.extinction[k];
    quality.largest = std::pow(kClassRatio, -static_cast<double>(k));
    quality.clusters = all.size();
    if (all.empty()) continue;
    const std::size_t tried = std::min(all.size(), kTriedClusters);
    std::vector<double> errors(tried), weights(tried);
    parallel_for(tried, 1, [&](std::size_t i) {
      const std::size_t c = all[i * all.size() / tried];
      errors[i] = extinction_error(world, surfaces, tree, c);
      weights[i] = static_cast<double>(tree.volume(c).surface_area());
    });
    double weight = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < tried; ++i) {
      weight += weights[i];
      quality.bias += weights[i] * errors[i];
      squares += weights[i] * errors[i] * errors[i];
    }
    quality.bias /= weight;
    quality.rms = std::sqrt(squares / weight);
  }
}

// Uniform over all surfaces; each end lifted to the side of the other.
std::vector<VisibilityRay> rays_between_surfaces(const World& world) {
  const Geometry& g = world.geometry;
  std::vector<double> cumulative;
  double area = 0.0;
  for (std::size_t t = 0; t < g.triangles.size(); ++t)
    cumulative.push_back(area += static_cast<double>(g.area(TriangleId(t))));
  struct Point {
    Vec3 position, normal;
  };
  const auto point = [&](std::uint64_t i) {
    const double wanted = area * static_cast<double>(to_unit_float(hash(i, 1)));
    const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, wanted);
    const TriangleId t(static_cast<std::size_t>(found - cumulative.begin()));
    const Vec2 b = uniform_triangle({to_unit_float(hash(i, 2)), to_unit_float(hash(i, 3))});
    return Point{g.point(t, b), glm::normalize(g.scaled_normal(t))};
  };
  std::vector<VisibilityRay> rays;
  if (g.triangles.empty()) return rays;
  for (std::uint64_t i = 0; i < kRays; ++i) {
    const Point a = point(2 * i), b = point(2 * i + 1);
    const Vec3 d = b.position - a.position;
    const Vec3 from =
        world.rays.lift(a.position, glm::dot(d, a.normal) > 0.f ? a.normal : -a.normal);
    const Vec3 to = world.rays.lift(b.position, glm::dot(d, b.normal) < 0.f ? b.normal : -b.normal);
    rays.push_back({from, to - from, 1.f});
  }
  return rays;
}

using RayAnswer = std::function<float(const VisibilityRay&, TraversalCount*)>;

RayQuality try_rays(const std::vector<VisibilityRay>& rays, const std::vector<float>& exact,
                    const RayAnswer& answer) {
  RayQuality quality;
  if (rays.empty()) return quality;
  TraversalCount count;
  double squares = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float light = answer(rays[i], &count);
    quality.mean += static_cast<double>(light);
    squares += static_cast<double>((light - exact[i]) * (light - exact[i]));
  }
  const auto start = std::chrono::steady_clock::now();
  float kept = 0.f;
  for (const VisibilityRay& ray : rays) kept += answer(ray, nullptr);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  const auto n = static_cast<double>(rays.size());
  quality.nodes = static_cast<double>(count.nodes) / n;
  quality.per_second = kept >= 0.f ? n / std::max(time.count(), 1e-9) : 0.0;
  quality.mean /= n;
  quality.rms = std::sqrt(squares / n);
  return quality;
}

void measure_rays(const World& world, const Surfaces& surfaces, const ClusterTree& clusters,
                  HierarchyMeasures& measures) {
  MultiresOptions options;
  options.extinction = ExtinctionRule::area;
  const MultiresTree tree(world.scene, world.geometry, surfaces, clusters, options);
  measures.visibility_bytes = tree.arrays().nodes.size() * sizeof(MultiresNode) +
                              tree.arrays().blocks.size() * sizeof(TriangleBlock);
  const std::vector<VisibilityRay> rays = rays_between_surfaces(world);
  std::vector<float> exact(rays.size());
  parallel_for(rays.size(), 256, [&](std::size_t i) {
    exact[i] = world.rays.transmittance(rays[i].receiver, rays[i].receiver + rays[i].direction);
  });
  const StopRule rule = StopRule::between(kFeatureShare * world.geometry.bounds.diagonal(), 0.f);
  measures.exact = try_rays(rays, exact, [&](const VisibilityRay& ray, TraversalCount* count) {
    return tree.multires(ray, StopRule::never(), count);
  });
  measures.average = try_rays(rays, exact, [&](const VisibilityRay& ray, TraversalCount* count) {
    return tree.average(ray, rule, count);
  });
  measures.multires = try_rays(rays, exact, [&](const VisibilityRay& ray, TraversalCount* count) {
    return tree.multires(ray, rule, count);
  });
}

}  // namespace

HierarchyMeasures measure_hierarchy(const World& world, const Surfaces& surfaces,
                                    const ClusterTree& tree) {
  HierarchyMeasures measures;
  const MeasuredTree facts(world, surfaces, tree);
  measure_shape(surfaces, tree, facts, measures);
  measure_extinction(world, surfaces, facts, measures);
  measure_rays(world, surfaces, tree, measures);
  return measures;
}

}  // namespace halflight
