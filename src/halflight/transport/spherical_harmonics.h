// Irradiance as a function of the normal, in real spherical harmonics up to order 2.
// Ramamoorthi & Hanrahan 2001, "An efficient representation for irradiance environment maps":
// E(n) = sum A_l e_lm Y_lm(n), A_0 = pi, A_1 = 2 pi / 3, A_2 = pi / 4.
#pragma once

#include <array>

#include "halflight/base/vec.h"

namespace halflight {

using SphericalHarmonics = std::array<float, 9>;

inline SphericalHarmonics evaluate_harmonics(const Vec3& w) {
  return {0.282095f,
          0.488603f * w.y,
          0.488603f * w.z,
          0.488603f * w.x,
          1.092548f * w.x * w.y,
          1.092548f * w.y * w.z,
          0.315392f * (3.f * w.z * w.z - 1.f),
          1.092548f * w.x * w.z,
          0.546274f * (w.x * w.x - w.y * w.y)};
}

struct DirectionalIrradiance {
  std::array<Rgb, 9> coefficients{};

  // Adds light that arrives from the unit direction `towards_source` and would give a surface
  // facing it the irradiance e.
  void add(const Vec3& towards_source, const Rgb& e) {
    const SphericalHarmonics y = evaluate_harmonics(towards_source);
    for (int i = 0; i < 9; ++i) coefficients[i] += y[i] * e;
  }
  // Adds light that gives every surface the irradiance e, whatever its normal.
  void add_isotropic(const Rgb& e) { coefficients[0] += e / (kPi * 0.282095f); }

  DirectionalIrradiance& operator+=(const DirectionalIrradiance& o) {
    for (int i = 0; i < 9; ++i) coefficients[i] += o.coefficients[i];
    return *this;
  }
  bool any() const { return coefficients[0] != Rgb(0.f); }
  // Ringing of the truncated series may go below zero: there no light is the better answer.
  Rgb irradiance(const Vec3& n) const {
    constexpr std::array<float, 9> cosine_lobe{kPi,           2.f * kPi / 3, 2.f * kPi / 3,
                                               2.f * kPi / 3, kPi / 4,       kPi / 4,
                                               kPi / 4,       kPi / 4,       kPi / 4};
    const SphericalHarmonics y = evaluate_harmonics(n);
    Rgb e(0.f);
    for (int i = 0; i < 9; ++i) e += cosine_lobe[i] * y[i] * coefficients[i];
    return glm::max(e, Rgb(0.f));
  }
};

}  // namespace halflight
