// BSIZE: the widest region of a cluster that blocks light, and the widest that lets it through,
// measured on orthographic binary pictures of its contents (paper section 3.3).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "halflight/base/vec.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// Both ends of each: 3 axes of the box, 6 directions between two of them, 4 between three.
inline constexpr int kPictureDirections = 13;
const std::array<Vec3, kPictureDirections>& picture_directions();
// The one with the least angle to d, of any length.
int nearest_picture_direction(const Vec3& d);

// What a cluster looks like along one direction: 64 pixels along the longer side of its box.
struct ClusterPicture {
  float blocked = 0.f;   // side of the largest square that lets nothing through, m
  float free = 0.f;      // side of the largest square inside the box that stops nothing, m
  float coverage = 0.f;  // blocked share of the box's projection
  float pixel = 0.f;     // m; widths are right to within one
  // Extinction for which the mean transmittance over the box's own chords is 1 - coverage (right
  // also for flat clusters, and for such whose contents are ordered), 1/m.
  float extinction = 0.f;

  // Pictures know no width below a few pixels: what is smaller counts as that, the safe side.
  float blocker_size() const;
};

// A pixel is blocked when its centre is covered by an opacity of at least one half.
ClusterPicture picture_cluster(const Scene& scene, const Geometry& geometry,
                               std::span<const TriangleId> contents, const Bounds3f& box,
                               const Vec3& direction);

// All directions. Their mean is the isotropic blocker size, the one that the paper uses.
struct BlockerSizes {
  std::array<ClusterPicture, kPictureDirections> pictures;

  float isotropic() const;
};
BlockerSizes measure_blocker_sizes(const Scene& scene, const Geometry& geometry,
                                   std::span<const TriangleId> contents, const Bounds3f& box);

}  // namespace halflight
