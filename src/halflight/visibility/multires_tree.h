// Multi-resolution visibility (paper section 3): one walk down a tree of clusters that stops where
// the contents of a cluster can throw no shadow wider than the feature size, and takes the cluster
// as a medium there.
#pragma once

#include <optional>
#include <vector>

#include "halflight/hierarchy/cluster_tree.h"
#include "halflight/visibility/blocker_size.h"
#include "halflight/visibility/criterion.h"
#include "halflight/visibility/multires_nodes.h"

namespace halflight {

// What the criterion takes for the size of the fictitious blocker.
enum class BlockerSizeRule : std::uint8_t {
  longest_side,  // of the cluster's box: never too small, and needs no pictures
  isotropic,     // BSIZE, the mean over all directions (paper)
  directional,   // BSIZE of the picture direction nearest to the ray
};

// What a stopped cluster takes away.
enum class ExtinctionRule : std::uint8_t {
  area,                 // the mean of A / 2V and A / 4V (paper; extinction.h)
  coverage,             // what its box covers on the mean (coverage_extinction.h)
  directional_coverage  // what the picture nearest to the ray covers (blocker_size.h)
};

struct MultiresOptions {
  BlockerSizeRule blocker_size = BlockerSizeRule::longest_side;
  ExtinctionRule extinction = ExtinctionRule::coverage;
  // Boxes smaller than this get no pictures but longest side and mean extinction, m.
  float smallest_picture = 0.f;
  // A cluster is opened when the receiver is nearer than this many longest sides of its box: leaves
  // would else lose the shadow of their own plant.
  float receiver_clearance = 0.5f;
};

// What rays have cost; adds up over all that were given the same count.
struct TraversalCount {
  std::uint64_t nodes = 0;     // looked into: eight clusters at once
  std::uint64_t clusters = 0;  // whose boxes they meet
  std::uint64_t stops = 0;     // slots taken as a medium
  std::uint64_t blocks = 0;    // of up to eight triangles, tested exactly
};

// Where a ray of closest_hit has ended.
struct MediumHit {
  RayHit surface;             // triangle invalid: absorbed inside a cluster
  std::uint32_t cluster = 0;  // of the ClusterTree, when absorbed
  std::uint32_t slot = 0;     // of the tree (8 * node + slot), when absorbed
  float distance = 0.f;       // in units of the direction

  bool in_cluster() const { return !surface.triangle.valid(); }
};

class MultiresTree {
 public:
  // Scene and geometry must outlive the tree.
  MultiresTree(const Scene& scene, const Geometry& geometry, const Surfaces& surfaces,
               const ClusterTree& clusters, const MultiresOptions& options = {});

  // Both: share of light that arrives; 0 below 1e-3. Every surface that the ray may meet counts
  // once: by a stopped cluster above it, or by itself. Clusters that hold an end of the ray are
  // never stopped at, or a receiver would darken itself.
  //
  // `multires` tests surfaces below which nothing has stopped exactly, with their opacity. The
  // paper ran its section 5 by extinction alone: `average` takes the surfaces of the last cluster
  // as a medium too, unless that holds an end of the ray. StopRule::never() makes it the paper's
  // reference.
  //
  // A feature size of 0 is no rule (clusters without an umbra would still stop): callers send such
  // rays to RayScene.
  float average(const VisibilityRay& ray, const StopRule& rule,
                TraversalCount* count = nullptr) const;
  float multires(const VisibilityRay& ray, const StopRule& rule,
                 TraversalCount* count = nullptr) const;

  // Where light that is followed back from the receiver was last scattered: the nearest surface, as
  // RayScene::closest_hit, or a point inside a stopped cluster, drawn by its extinction. The answer
  // is a function of the seed alone.
  std::optional<MediumHit> closest_hit(const VisibilityRay& ray, const StopRule& rule,
                                       std::uint64_t seed) const;

  // Nearest of the surfaces below a slot, as RayScene::closest_hit would find it without the
  // others.
  std::optional<RayHit> nearest_below(std::uint32_t slot, const VisibilityRay& ray,
                                      std::uint64_t seed) const;

  // What a ray's walk consists of, for tests and pictures: the parts below which it did not look.
  struct CutPart {
    bool stopped = false;  // as a medium; else tested exactly
    std::uint32_t cluster = 0;
    Bounds3f box;
    float extinction = 0.f;
    std::vector<TriangleId> triangles;
  };
  std::vector<CutPart> cut(const VisibilityRay& ray, const StopRule& rule, bool average) const;

  const MultiresOptions& options() const { return options_; }
  const MultiresNodes& arrays() const { return arrays_; }

 private:
  void take_pictures();
  std::vector<TriangleId> contents(std::size_t slot) const;
  template <class Visitor>
  void walk(const VisibilityRay& ray, const StopRule& rule, bool average, Visitor& visit,
            std::uint32_t root = 0) const;

  const Scene* scene_;
  const Geometry* geometry_;
  MultiresOptions options_;
  MultiresNodes arrays_;
  std::vector<DirectionalRow> rows_;  // 13 a node; none when no answer depends on the direction
};

}  // namespace halflight
