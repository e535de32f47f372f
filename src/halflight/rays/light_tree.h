// Chooses one of many lights with a probability close to its share of the unoccluded irradiance.
// A binary tree over the lights; at every node the child is drawn by an upper estimate
// intensity x cosines / d^2. Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
// Adaptive Tree Splitting", without the splitting. Blind to occlusion.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"

namespace halflight {

using EmitterId = Id<struct EmitterTag>;

// What the tree knows of one light, or of a group of lights.
struct LightBounds {
  Bounds3f bounds;
  Vec3 axis{0.f, 0.f, 1.f};  // of the cone that holds all directions in which the light faces
  float cos_cone = 1.f;      // half angle of that cone; -1: every direction
  bool two_sided = false;    // also faces the opposite directions
  float intensity = 0.f;     // W/sr (or candela) straight ahead
};

class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::span<const LightBounds> lights);

  struct Choice {
    EmitterId emitter;
    float probability = 0.f;
  };
  // Nothing when no light can reach the side of the surface at p that the unit normal n points to.
  std::optional<Choice> choose(const Vec3& p, const Vec3& n, float u) const;
  // The probability that choose(p, n, .) returns this light.
  float probability(EmitterId emitter, const Vec3& p, const Vec3& n) const;

 private:
  struct Node {
    LightBounds light;
    std::uint32_t right = 0;  // second child; the first one follows its parent. 0: a leaf
    EmitterId emitter;        // of a leaf
  };
  std::vector<Node> nodes_;
  // From the root to each emitter: bit k says which child is taken at depth k. Splits are by
  // median, so that depth is at most 32.
  std::vector<std::uint32_t> trails_;
};

// Upper estimate, W/m2, of the irradiance that the light sends to the side at p that n points to.
float irradiance_estimate(const LightBounds& light, const Vec3& p, const Vec3& n);

}  // namespace halflight
