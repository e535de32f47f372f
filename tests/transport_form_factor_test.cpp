// Form factors between whole rectangles, by the closed form and by the solver's links.
#include <gtest/gtest.h>

#include <string>

#include "halflight/base/hash.h"
#include "halflight/rays/sampling.h"
#include "halflight/transport/form_factor.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

// Two unit squares and the form factor from one to the other (Howell, configurations C-11, C-14).
struct SquarePair {
  const char* name;
  float form_factor;
  Vec3 source, source_u, source_v;  // corner and sides; the front faces the receiver
};

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

const SquarePair kPairs[] = {{"HalfApart", 0.415253f, {0, 0.5f, 0}, kX, kZ},
                             {"OneApart", 0.199825f, {0, 1, 0}, kX, kZ},
                             {"TwoApart", 0.068590f, {0, 2, 0}, kX, kZ},
                             {"CommonEdge", 0.200044f, {0, 0, 0}, kY, kZ}};

class FormFactors : public ::testing::TestWithParam<SquarePair> {};

// The receiver: the unit square of the floor, facing up.
TEST_P(FormFactors, ClosedFormIntegratedOverTheReceiver) {
  const SquarePair& p = GetParam();
  const std::array<Vec3, 4> source{p.source, p.source + p.source_u,
                                   p.source + p.source_u + p.source_v, p.source + p.source_v};
  constexpr int kSteps = 64;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 x((static_cast<float>(i) + 0.5f) / kSteps, 0.f,
                   (static_cast<float>(k) + 0.5f) / kSteps);
      sum += static_cast<double>(polygon_form_factor(x, kY, source));
    }
  EXPECT_NEAR(sum / (kSteps * kSteps), p.form_factor, 0.002 * p.form_factor);
}

TEST_P(FormFactors, LinksOfABlackReceiverAddUp) {
  const SquarePair& p = GetParam();
  QuadScene scene;
  const MaterialId black = scene.material(0.f), light = scene.material(0.f, 1.f);
  scene.quad({0, 0, 0}, kZ, kX, black);
  scene.quad(p.source, p.source_u, p.source_v, light);
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::refined, 0.05f, 0.01f));
  const SideId floor = side_of(state.surfaces->of_triangle[TriangleId(0)], false);
  ASSERT_GT(state.surfaces->normal(floor).y, 0.99f);
  EXPECT_NEAR(testing::mean_irradiance_of(state, floor) / kPi, p.form_factor,
              0.01f * p.form_factor);
}

INSTANTIATE_TEST_SUITE_P(Squares, FormFactors, ::testing::ValuesIn(kPairs),
                         [](const auto& test) { return std::string(test.param.name); });

std::array<Vec3, 4> wall_of_unit_box(int axis, bool high) {
  const Vec3 u = axis == 0 ? kY : kX, v = axis == 2 ? kY : kZ;
  Vec3 corner(0.f);
  corner[axis] = high ? 1.f : 0.f;
  return {corner, corner + u, corner + u + v, corner + v};
}

TEST(FormFactorRows, FiveWallsFillTheHemisphereOfThePointsOfTheSixth) {
  for (const Vec3 x : {Vec3(0.5f, 0, 0.5f), Vec3(0.01f, 0, 0.99f), Vec3(0.3f, 0, 0.002f)}) {
    float row = 0.f;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true})
        if (axis != 1 || high) row += polygon_form_factor(x, kY, wall_of_unit_box(axis, high));
    EXPECT_NEAR(row, 1.f, 1e-4f);
  }
}

TEST(FormFactorRows, LinksOfEveryWallOfAGlowingBlackBoxAddUpToOne) {
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled}) {
    QuadScene scene;
    scene.box(Vec3(0.f), Vec3(1.f), scene.material(0.f, 1.f), true);
    const SolverState state = testing::solve(scene.scene, testing::options_of(links, 0.05f, 0.02f));
    ASSERT_EQ(state.surfaces->surfaces.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(testing::mean_irradiance_of(state, side_of(SurfaceId(i), false)) / kPi, 1.f,
                  0.01f);
  }
}

TEST(FormFactorOfPolygon, WhatLiesBelowTheHorizonDoesNotCount) {
  // A square that stands on the floor's plane and reaches as far below it.
  const std::array<Vec3, 4> both{Vec3(-1, -1, 1), Vec3(1, -1, 1), Vec3(1, 1, 1), Vec3(-1, 1, 1)};
  const std::array<Vec3, 4> above{Vec3(-1, 0, 1), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(-1, 1, 1)};
  const float f = polygon_form_factor(Vec3(0.f), kY, above);
  EXPECT_GT(f, 0.05f);
  EXPECT_NEAR(polygon_form_factor(Vec3(0.f), kY, both), f, 1e-6f);
  const std::array<Vec3, 3> below{Vec3(-1, -1, 1), Vec3(1, -1, 1), Vec3(0, -2, 1)};
  EXPECT_EQ(polygon_form_factor(Vec3(0.f), kY, below), 0.f);
}

// Bulbs are made of thousands of facets, and seen from afar.
TEST(FormFactorOfPolygon, OfSmallAndFarTrianglesIsThatOfTheirArea) {
  for (const float size : {1e-2f, 1e-3f, 1e-4f, 1e-5f}) {
    double sum = 0.0, expected = 0.0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Vec3 x = uniform_sphere(random_shift(hash(i, 1)));
      const Vec3 n = uniform_sphere(random_shift(hash(i, 2)));
      const Vec3 u = size * uniform_sphere(random_shift(hash(i, 3)));
      const Vec3 v = size * uniform_sphere(random_shift(hash(i, 4)));
      const Vec3 centre = x + uniform_sphere(random_shift(hash(i, 5)));
      const std::array<Vec3, 3> corners{centre, centre + u, centre + v};
      const Vec3 scaled_normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
      const Vec3 to = (corners[0] + corners[1] + corners[2]) / 3.f - x;
      const float squared = glm::dot(to, to);
      if (glm::dot(to, n) < 0.1f) continue;
      sum += static_cast<double>(polygon_form_factor(x, n, corners));
      expected += static_cast<double>(0.5f * std::abs(glm::dot(scaled_normal, to)) *
                                      glm::dot(to, n) / (kPi * squared * squared));
    }
    EXPECT_NEAR(sum / expected, 1.0, 0.02) << size;
  }
}

TEST(FormFactorOfPolygon, AgreesWithTheCornerFormulaOfParallelRectangles) {
  const std::array<Vec3, 4> panel{Vec3(0, 0.7f, 0), Vec3(1.3f, 0.7f, 0), Vec3(1.3f, 0.7f, 0.4f),
                                  Vec3(0, 0.7f, 0.4f)};
  EXPECT_NEAR(polygon_form_factor(Vec3(0.f), kY, panel),
              testing::corner_form_factor(1.3f, 0.4f, 0.7f), 1e-6f);
}

}  // namespace
}  // namespace halflight
