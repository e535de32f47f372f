// Irradiance by spherical harmonics up to order 2, against a cosine lobe sampled directly.
#include "halflight/transport/spherical_harmonics.h"

#include <gtest/gtest.h>

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::uint32_t kDirections = 20000;

// Mean over the sphere of f(w), times 4 pi.
template <class F>
double over_sphere(const F& f) {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < kDirections; ++k)
    sum += static_cast<double>(f(uniform_sphere(r2_sequence(k))));
  return sum * static_cast<double>(4.f * kPi) / kDirections;
}

TEST(SphericalHarmonics, AreOrthonormal) {
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = 0; k <= i; ++k)
      EXPECT_NEAR(over_sphere([&](const Vec3& w) {
                    const SphericalHarmonics y = evaluate_harmonics(w);
                    return y[i] * y[k];
                  }),
                  i == k ? 1.0 : 0.0, 2e-3)
          << i << " " << k;
}

// Radiance 1 + a.w + (b.w)^2 has no higher orders. With t the part of b across the normal its
// irradiance is pi + 2 pi / 3 a.n + pi (2 (b.n)^2 + |t|^2) / 4.
TEST(SphericalHarmonics, GiveTheIrradianceOfRadianceOfSecondOrder) {
  const Vec3 a(0.2f, -0.3f, 0.4f), b(0.6f, 0.5f, -0.3f);
  DirectionalIrradiance light;
  for (std::uint32_t k = 0; k < kDirections; ++k) {
    const Vec3 w = uniform_sphere(r2_sequence(k));
    const float radiance = 1.f + glm::dot(a, w) + glm::dot(b, w) * glm::dot(b, w);
    light.add(w, Rgb(radiance * 4.f * kPi / static_cast<float>(kDirections)));
  }
  for (std::uint32_t k = 0; k < 50; ++k) {
    const Vec3 n = uniform_sphere(r2_sequence(k));
    const float along = glm::dot(b, n), across = glm::dot(b, b) - along * along;
    const float expected =
        kPi + 2.f * kPi / 3.f * glm::dot(a, n) + kPi * (2.f * along * along + across) / 4.f;
    EXPECT_NEAR(light.irradiance(n).g, expected, 2e-3f * expected);
  }
}

TEST(SphericalHarmonics, LightFromAllAroundIsTheSameForEveryNormal) {
  DirectionalIrradiance light;
  light.add_isotropic(Rgb(3.f));
  for (std::uint32_t k = 0; k < 20; ++k)
    EXPECT_NEAR(light.irradiance(uniform_sphere(r2_sequence(k))).g, 3.f, 1e-5f);
}

// The series says 1/4 + c/2 + 5/16 P_2(c) for a cosine c, above the lobe on both ends and below
// zero between.
TEST(SphericalHarmonics, LightFromOneDirectionFallsOnWhatFacesIt) {
  const Vec3 d = glm::normalize(Vec3(1.f, 2.f, -2.f)), across = Frame::from_normal(d).tangent;
  DirectionalIrradiance light;
  light.add(d, Rgb(1.f));
  EXPECT_NEAR(light.irradiance(d).g, 17.f / 16.f, 1e-4f);
  EXPECT_NEAR(light.irradiance(across).g, 3.f / 32.f, 1e-4f);
  EXPECT_NEAR(light.irradiance(-d).g, 1.f / 16.f, 1e-4f);
  EXPECT_EQ(light.irradiance(glm::normalize(-d + 1.6f * across)).g, 0.f);
}

}  // namespace
}  // namespace halflight
