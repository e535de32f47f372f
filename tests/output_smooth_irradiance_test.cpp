// Irradiance continued linearly over cells: nearer to the truth than constants, same means.
#include "halflight/output/smooth_irradiance.h"

#include <gtest/gtest.h>

#include "halflight/rays/sampling.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

// A floor of which every cell holds the value of a given function at its middle.
template <class F>
SolverState floor_with(const F& light_at) {
  testing::QuadScene quads;
  quads.quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, quads.material(0.5f));
  quads.quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, quads.material(0.f, 1.f));
  SolverState state = make_state(make_world(quads.scene), {.feature_size = 0.1f});
  ElementTree& tree = state.tree;
  for (std::size_t i = 0; i < tree.size() && tree.size() < 500; ++i)
    if (tree[ElementId(i)].is_leaf_cell()) tree.split(ElementId(i));
  state.irradiance.resize(tree.size(), Rgb(0.f));
  for (std::size_t i = 0; i < tree.size(); ++i)
    state.irradiance[ElementId(i)] = Rgb(light_at(tree[ElementId(i)].center()));
  return state;
}

template <class F>
void for_points_of_the_floor(const SolverState& state, const F& visit) {
  const ElementTree& tree = state.tree;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId leaf(i);
    if (!tree[leaf].is_leaf_cell() || tree[leaf].center().y > 1.f) continue;
    for (std::uint32_t k = 0; k < 16; ++k) visit(leaf, tree.sample(leaf, r2_sequence(k)).position);
  }
}

TEST(SmoothIrradiance, ReproducesALinearOne) {
  const auto light = [](const Vec3& p) { return 3.f + 0.5f * p.x - 0.25f * p.z; };
  const SolverState state = floor_with(light);
  const SmoothIrradiance smooth(state);
  for_points_of_the_floor(state, [&](ElementId leaf, const Vec3& p) {
    EXPECT_NEAR(smooth.at(leaf, p).g, light(p), 1e-3f);
  });
}

TEST(SmoothIrradiance, ComesNearerToACurvedOneThanConstants) {
  const auto light = [](const Vec3& p) { return 2.f + std::sin(2.f * p.x) * std::cos(p.z); };
  const SolverState state = floor_with(light);
  const SmoothIrradiance smooth(state);
  double of_constants = 0.0, of_smooth = 0.0;
  for_points_of_the_floor(state, [&](ElementId leaf, const Vec3& p) {
    of_constants += std::abs(state.irradiance[leaf].g - light(p));
    of_smooth += std::abs(smooth.at(leaf, p).g - light(p));
  });
  EXPECT_LT(of_smooth, 0.75 * of_constants);
}

TEST(SmoothIrradiance, MakesNoOvershootAtAnEdge) {
  const auto light = [](const Vec3& p) { return p.x < 2.f ? 1.f : 9.f; };
  const SolverState state = floor_with(light);
  const SmoothIrradiance smooth(state);
  for_points_of_the_floor(state, [&](ElementId leaf, const Vec3& p) {
    EXPECT_GE(smooth.at(leaf, p).g, 0.99f);
    EXPECT_LE(smooth.at(leaf, p).g, 9.01f);
  });
}

// Where a slope gets steeper, the gentle side knows nothing of it yet.
TEST(SmoothIrradiance, TakesTheGentlerSlopeAtABend) {
  const auto light = [](float x) { return x < 2.f ? 1.f + 0.1f * x : 1.2f + 4.f * (x - 2.f); };
  const SolverState state = floor_with([&](const Vec3& p) { return light(p.x); });
  const SmoothIrradiance smooth(state);
  for_points_of_the_floor(state, [&](ElementId leaf, const Vec3& p) {
    const float size = state.tree.cell_size(leaf);
    EXPECT_GE(smooth.at(leaf, p).g, light(p.x - size) - 1e-3f) << p.x;
    EXPECT_LE(smooth.at(leaf, p).g, light(p.x + size) + 1e-3f) << p.x;
  });
}

// Cells of independent noise whose variance is known; the floor's light is 3 +- 1 along x.
TEST(SmoothIrradiance, LeavesOutNoiseAndKeepsEdges) {
  constexpr float kNoise = 0.2f;
  const auto slope = [](const Vec3& p) { return 2.f + 0.5f * p.x; };
  const auto edge = [](const Vec3& p) { return p.x < 2.f ? 1.f : 9.f; };
  const auto rms_error = [&](const auto& light, bool known) {
    SolverState state = floor_with(light);
    IdVector<ElementId, float> variance(state.tree.size(), 0.f);
    for (std::size_t i = 0; i < state.tree.size(); ++i) {
      const ElementId e(i);
      const float noise = std::sqrt(12.f) * kNoise * (to_unit_float(hash(i, 5)) - 0.5f);
      state.irradiance[e] += Rgb(noise);
      if (known) variance[e] = kNoise * kNoise;
    }
    const SmoothIrradiance smooth(state.tree, state.irradiance, variance);
    double squares = 0.0, count = 0.0;
    for_points_of_the_floor(state, [&](ElementId leaf, const Vec3& p) {
      const auto error = static_cast<double>(smooth.at(leaf, p).g - light(p));
      squares += error * error;
      count += 1.0;
    });
    return std::sqrt(squares / count);
  };
  EXPECT_LT(rms_error(slope, true), 0.5 * rms_error(slope, false));
  EXPECT_LT(rms_error(edge, true), 0.6 * rms_error(edge, false));
}

}  // namespace
}  // namespace halflight
