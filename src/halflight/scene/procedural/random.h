// A stream of random numbers from a seed, for building scenes one thing after another.
#pragma once

#include <cstdint>

#include "halflight/base/hash.h"
#include "halflight/base/vec.h"

namespace halflight {

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}

  float uniform() { return to_unit_float(hash(seed_, drawn_++)); }  // in [0, 1)
  float uniform(float lower, float upper) { return lower + (upper - lower) * uniform(); }
  int below(int n) { return static_cast<int>(uniform() * static_cast<float>(n)); }  // in [0, n)
  float angle() { return uniform(0.f, 2.f * kPi); }
  Vec3 point_in(const Bounds3f& box) {
    const float x = uniform(), y = uniform(), z = uniform();
    return box.lower + Vec3(x, y, z) * box.extent();
  }
  // Uniform over the unit sphere.
  Vec3 direction() {
    const float z = uniform(-1.f, 1.f), phi = angle();
    const float r = std::sqrt(std::max(0.f, 1.f - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
};

}  // namespace halflight
