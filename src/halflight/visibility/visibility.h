// How much of the light from one point arrives at another: one question, three answers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "halflight/base/counter.h"
#include "halflight/rays/world.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight {

enum class VisibilityMode : std::uint8_t {
  exact,    // every surface (rays/ray_scene.h)
  average,  // clusters as media down to the last (Sillion 1994; paper section 5)
  multires  // clusters as media where that throws no visible shadow, surfaces exactly (section 3)
};

struct NamedVisibilityMode {
  VisibilityMode mode;
  std::string_view name;  // on the command line and in reports
};
inline constexpr std::array kVisibilityModes{
    NamedVisibilityMode{VisibilityMode::exact, "exact"},
    NamedVisibilityMode{VisibilityMode::average, "average"},
    NamedVisibilityMode{VisibilityMode::multires, "multires"}};
std::string_view name_of(VisibilityMode mode);

struct RayEnds {
  Vec3 receiver{0.f};
  Vec3 emitter{0.f};
  float feature_size = 0.f;  // s on the receiver, m; 0: exact, bit for bit
  // Smallest projected width of the whole emitter, m; 0: a point. Parts of an emitter have larger
  // umbras than the whole, which would open more clusters the finer it is split.
  float emitter_size = 0.f;
};

// Thread-safe. Refers to the world, and while it is built to surfaces and clusters.
class Visibility {
 public:
  explicit Visibility(const World& world) : world_(&world) {}  // exact
  Visibility(const World& world, const Surfaces& surfaces, const ClusterTree& clusters,
             VisibilityMode mode, const MultiresOptions& options = {});

  // The same in a world that differs by its light alone. Emitters keep their widths.
  Visibility(Visibility other, const World& relit) : Visibility(std::move(other)) {
    world_ = &relit;
  }

  const World& world() const { return *world_; }
  VisibilityMode mode() const { return mode_; }
  // None in exact mode.
  const MultiresTree* tree() const { return tree_.get(); }

  // Through clusters so far; exact rays are counted by RayScene.
  std::uint64_t ray_total() const { return counts_->rays.total(); }
  std::uint64_t node_total() const { return counts_->nodes.total(); }

  // RayEnds::emitter_size of a place on an emitting triangle: the width of the whole emitter,
  // foreshortened as the ray sees it. 0 in exact mode, which does not ask.
  float emitter_size(TriangleId triangle, const Vec3& receiver, const Vec3& emitter) const;
  // Share of the light that arrives, in [0, 1].
  float transmittance(const RayEnds& ends) const;
  // From an emitter at infinity (unit direction towards it), seen under an angular diameter in
  // radians: 0 for a distant light, 0.0093 for the sun, more for a part of the sky.
  float transmittance_to_sky(const Vec3& receiver, const Vec3& direction, float feature_size,
                             float angular_diameter) const;
  // For light paths: the nearest surface, or a point inside a cluster that may stand for its
  // contents. `spread` is the angle in radians between neighbouring rays of the bundle that this
  // one belongs to: clusters within the bundle's width, feature_size + spread * distance, are
  // media. Unit direction. In average mode surfaces are exact all the same: light has to land on
  // something.
  std::optional<MediumHit> closest_hit(const Vec3& receiver, const Vec3& direction,
                                       float max_distance, float feature_size, float spread,
                                       std::uint64_t seed) const;

 private:
  bool exact(float feature_size) const {
    return mode_ == VisibilityMode::exact || !(feature_size > 0.f);
  }
  float through_tree(const VisibilityRay& ray, const StopRule& rule) const;

  const World* world_;
  VisibilityMode mode_ = VisibilityMode::exact;
  std::shared_ptr<const MultiresTree> tree_;
  IdVector<TriangleId, float> emitter_widths_;
  struct Counts {
    Counter rays, nodes;
  };
  std::shared_ptr<Counts> counts_ = std::make_shared<Counts>();  // of all that share the tree
};

}  // namespace halflight
