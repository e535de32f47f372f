// Light groups: mixing them gives the light of a scene whose lamps were changed and solved anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>

#include "halflight/output/estimated_error.h"
#include "halflight/scene/light_groups.h"
#include "halflight/solve/mix.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

// A closed room with a table, lit by a ceiling lamp and a dim lamp under the table.
Scene two_lamps() {
  testing::QuadScene quads;
  const MaterialId wall = quads.material(0.6f);
  quads.box({0, 0, 0}, {4, 3, 5}, wall, true);
  quads.quad({1, 1, 1}, {0, 0, 2}, {2, 0, 0}, wall);
  quads.quad({1, 0.9f, 1}, {2, 0, 0}, {0, 0, 2}, wall);
  quads.quad({1.5f, 2.9f, 2}, {1, 0, 0}, {0, 0, 1}, quads.material(0.5f, 10.f));
  quads.quad({1.9f, 0.8f, 1.9f}, {0.2f, 0, 0}, {0, 0, 0.2f}, quads.material(0.5f, 2.f));
  quads.scene.materials[MaterialId(std::size_t{1})].name = "ceiling";
  quads.scene.materials[MaterialId(std::size_t{2})].name = "table";
  return quads.scene;
}

// A room with an open side, lit by a punctual light and the sky.
Scene open_room() {
  testing::QuadScene quads;
  const MaterialId wall = quads.material(0.7f);
  quads.quad({0, 0, 0}, {0, 0, 5}, {4, 0, 0}, wall);
  quads.quad({0, 3, 0}, {4, 0, 0}, {0, 0, 5}, wall);
  quads.quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, wall);
  quads.quad({0, 0, 0}, {0, 3, 0}, {0, 0, 5}, wall);
  quads.quad({1.2f, 1, 1}, {0, 0, 1}, {1, 0, 0}, wall);
  Light light;
  light.name = "bulb";
  light.intensity = Rgb(3.f);
  quads.light_shining_down(light, {2, 2.5f, 2.5f});
  quads.scene.sky = Rgb(0.5f);
  return quads.scene;
}

SolverState solve_groups(const Scene& scene, const SolveOptions& options) {
  const auto world = make_world(scene);
  SolverState state = make_state(world, options);
  set_groups(state, *find_light_groups(scene));
  const Progress progress;
  while (!state.done()) {
    advance(state, progress);
    if (state.history.size() == 1) balance(state, progress);
  }
  separate(state, progress);
  return state;
}

float relative_rms(const std::vector<float>& values, const std::vector<float>& truth) {
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double d = static_cast<double>(values[i]) - static_cast<double>(truth[i]);
    squares += d * d;
  }
  return static_cast<float>(std::sqrt(squares / static_cast<double>(truth.size()))) /
         testing::mean(truth);
}

// Each of two solutions may be off by the error that they aim at.
constexpr float kBothErrors = 1.42f * 0.05f;

struct Case {
  const char* name;
  Scene (*scene)();
  LinkMaker links;
};

class Mix : public ::testing::TestWithParam<Case> {};

TEST_P(Mix, EqualsASolveOfTheChangedScene) {
  const Scene scene = GetParam().scene();
  const SolveOptions options = testing::options_of(GetParam().links, 0.15f);
  SolverState state = solve_groups(scene, options);
  const auto groups = state.grouped.groups;
  ASSERT_EQ(groups.size(), 2u);
  const auto sensors = scatter_points(state, 150);
  for (const std::vector<Rgb>& factors :
       {std::vector{Rgb(1.f), Rgb(1.f)}, std::vector{Rgb(0.f), Rgb(1.f)},
        std::vector{Rgb(1.f), Rgb(0.f)}, std::vector{Rgb(0.02f, 0.1f, 0.f), Rgb(3.f)}}) {
    relight(state, factors);
    mix(state, factors);
    const SolverState anew = testing::solve(with_factors(scene, groups, factors), options);
    EXPECT_LT(relative_rms(testing::read_irradiance(state, sensors),
                           testing::read_irradiance(anew, sensors)),
              kBothErrors)
        << factors[0].r << " " << factors[1].r;
  }
}

TEST_P(Mix, IsLinear) {
  SolverState state =
      solve_groups(GetParam().scene(), testing::options_of(GetParam().links, 0.5f, 0.2f));
  const auto mixed = [&](std::vector<Rgb> factors) {
    mix(state, factors);
    return state.radiosity;
  };
  const auto both = mixed({Rgb(2.f), Rgb(0.5f)}), first = mixed({Rgb(2.f), Rgb(0.f)}),
             second = mixed({Rgb(0.f), Rgb(0.5f)}), none = mixed({Rgb(0.f), Rgb(0.f)});
  float brightest = 0.f;
  for (std::size_t i = 0; i < both.size(); ++i) {
    const ElementId e(i);
    brightest = std::max(brightest, average(both[e]));
    EXPECT_NEAR(average(both[e]), average(first[e] + second[e]), 1e-5f * (1.f + average(both[e])));
    EXPECT_EQ(none[e], Rgb(0.f));
  }
  EXPECT_GT(brightest, 0.1f);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Mix,
                         ::testing::Values(Case{"LampsSampled", two_lamps, LinkMaker::sampled},
                                           Case{"LampsRefined", two_lamps, LinkMaker::refined},
                                           Case{"OpenRoomSampled", open_room, LinkMaker::sampled}),
                         [](const auto& test) { return test.param.name; });

// What is dim beside another group gets elements for its own shadows.
TEST(LightGroups, DimGroupsAreRefinedAsWell) {
  const Scene scene = two_lamps();
  const SolveOptions options = testing::options_of(LinkMaker::sampled, 0.1f);
  const SolverState together = testing::solve(scene, options);
  const SolverState apart = solve_groups(scene, options);
  const auto cells_on_the_floor_below = [](const SolverState& state) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < state.tree.size(); ++i) {
      const Element& e = state.tree[ElementId(i)];
      const Vec3 c = e.center();
      count += e.is_leaf_cell() && c.y < 1e-3f && c.x > 1.f && c.x < 3.f && c.z > 1.f && c.z < 3.f;
    }
    return count;
  };
  EXPECT_GT(cells_on_the_floor_below(apart), 2 * cells_on_the_floor_below(together));
}

TEST(LightGroups, OfManyNamesAreFoundSoon) {
  testing::QuadScene quads;
  const MaterialId lamp = quads.material(0.5f);
  quads.scene.materials[lamp].emission = Rgb(1.f);
  quads.quad(Vec3(0.f), Vec3(0.f, 0.f, 1.f), Vec3(1.f, 0.f, 0.f), lamp);
  Material material = quads.scene.materials[lamp];
  Primitive primitive = quads.scene.meshes.back().primitives.front();
  constexpr std::size_t kMany = 60'000;
  for (std::size_t i = 0; i < kMany; ++i) {
    material.name = "lamp " + std::to_string(i);
    primitive.material = quads.scene.materials.push_back(material);
    quads.scene.meshes.back().primitives.push_back(primitive);
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto groups = find_light_groups(quads.scene);
  ASSERT_TRUE(groups);
  EXPECT_EQ(groups->size(), kMany + 1);
  EXPECT_EQ(groups->back().name, "lamp 59999");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

TEST(LightGroups, AreFoundByName) {
  Scene scene = two_lamps();
  scene.sky = Rgb(1.f);
  const auto names = [&](std::string_view together) {
    const auto groups = find_light_groups(scene, together);
    if (!groups) return groups.error().line();
    std::string text;
    for (const LightGroup& g : *groups) text += g.name + ";";
    return text;
  };
  EXPECT_EQ(names(""), "ceiling;table;sky;");
  EXPECT_EQ(names("inside=table,ceiling"), "inside;sky;");
  EXPECT_EQ(names("sky=ceiling,sky;"), "sky;table;");
  EXPECT_THAT(names("lamp=desk"), HasSubstr("nothing named 'desk'"));
  EXPECT_THAT(names("a=table;b=table"), HasSubstr("nothing named 'table' is left"));
  EXPECT_THAT(names("ceiling"), HasSubstr("is no group of lights"));
  EXPECT_THAT(names("=table"), HasSubstr("is no group of lights"));
  EXPECT_THAT(names("sky=table"), HasSubstr("two groups are called 'sky'"));
}

}  // namespace
}  // namespace halflight
