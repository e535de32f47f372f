#include "halflight/scene/procedural/catalogue.h"

#include <gtest/gtest.h>

#include "halflight/base/hash.h"
#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"

namespace halflight {
namespace {

template <class Visit>
void for_each_triangle(const Geometry& g, const Visit& visit) {
  for (std::size_t i = 0; i < g.triangles.size(); ++i) visit(TriangleId(i));
}

Vec3 unit_direction(std::uint64_t seed) {
  const float z = 2.f * to_unit_float(hash(seed, 1)) - 1.f;
  const float phi = 2.f * kPi * to_unit_float(hash(seed, 2));
  const float r = std::sqrt(std::max(0.f, 1.f - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

bool is_closed(const std::string& name) { return name != "cornell-box" && name != "cube-groups"; }

// Every scene of the catalogue with its default parameters.
class BuiltInScene : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    scene_ = find_recipe(GetParam()).value().build();
    geometry_ = flatten(scene_);
  }
  Scene scene_;
  Geometry geometry_;
};

TEST_P(BuiltInScene, HasTrianglesCamerasAndNames) {
  EXPECT_GT(geometry_.triangles.size(), 10u);
  EXPECT_EQ(geometry_.degenerate_triangles, 0u);
  EXPECT_FALSE(geometry_.cameras.empty());
  for (const Node& node : scene_.nodes) EXPECT_FALSE(node.name.empty());
  for (const Material& material : scene_.materials) EXPECT_FALSE(material.name.empty());
}

TEST_P(BuiltInScene, NormalsOfTheFileAgreeWithTheWinding) {
  for_each_triangle(geometry_, [&](TriangleId t) {
    for (const VertexId v : geometry_.triangles[t])
      ASSERT_GT(glm::dot(geometry_.normal(v), geometry_.scaled_normal(t)), 0.f) << t.value;
  });
}

TEST_P(BuiltInScene, EmittersShineFromTheirFrontIntoOpenSpace) {
  const RayScene rays(scene_, geometry_);
  int emitters = 0;
  for_each_triangle(geometry_, [&](TriangleId t) {
    if (!scene_.materials[geometry_.materials[t]].emits()) return;
    ++emitters;
    EXPECT_FALSE(scene_.materials[geometry_.materials[t]].double_sided);
    const auto [a, b, c] = geometry_.corners(t);
    const Vec3 normal = glm::normalize(geometry_.scaled_normal(t));
    const auto hit = rays.closest_hit(rays.lift((a + b + c) / 3.f, normal), normal, kInfinity, 1);
    ASSERT_TRUE(hit) << geometry_.instances[t].value;
    EXPECT_GT(hit->distance, 0.005f) << geometry_.instances[t].value;
    EXPECT_TRUE(hit->front || scene_.materials[geometry_.materials[hit->triangle]].double_sided);
  });
  EXPECT_GT(emitters, 0);
}

TEST_P(BuiltInScene, ClosedRoomsLetNoRayOutAndShowFrontsOnly) {
  const RayScene rays(scene_, geometry_);
  for (const PlacedCamera& camera : geometry_.cameras) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const auto hit = rays.closest_hit(camera.position, unit_direction(i), kInfinity, i);
      if (!hit) {
        ASSERT_FALSE(is_closed(GetParam())) << camera.name << ", ray " << i;
        continue;
      }
      const Material& material = scene_.materials[geometry_.materials[hit->triangle]];
      const bool as_meant = hit->front || material.double_sided || !is_closed(GetParam());
      ASSERT_TRUE(as_meant) << material.name << ", ray " << i;
    }
  }
}

TEST_P(BuiltInScene, ReflectancesArePhysical) {
  for (const Material& material : scene_.materials) {
    EXPECT_GE(min_component(material.reflectance), 0.f) << material.name;
    EXPECT_LE(max_component(material.reflectance), 0.9f) << material.name;
  }
}

// The scene's vertices with the seed moved on by `step`.
std::vector<Vec3> vertices_of(const std::string& name, int step) {
  Recipe recipe = find_recipe(name).value();
  for (const Knob& knob : recipe.knobs) {
    if (knob.name == "boxes") *std::get<int*>(knob.value) = 5;
    if (knob.name == "seed") *std::get<int*>(knob.value) += step;
  }
  return flatten(recipe.build()).positions.raw();
}

TEST_P(BuiltInScene, TheSeedDecidesEverything) {
  const Recipe recipe = find_recipe(GetParam()).value();
  const bool has_seed = recipe.knobs.back().name == "seed";
  EXPECT_EQ(vertices_of(GetParam(), 0), vertices_of(GetParam(), 0));
  EXPECT_EQ(vertices_of(GetParam(), 0) != vertices_of(GetParam(), 1), has_seed);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, BuiltInScene, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const Recipe& recipe : scene_recipes())
                             names.push_back(recipe.name);
                           return names;
                         }()),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(SceneCatalogue, AnUnknownNameListsTheKnownOnes) {
  const auto missing = find_recipe("ballroom");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().line().find("ballroom"), std::string::npos);
  EXPECT_NE(missing.error().line().find("office"), std::string::npos);
}

}  // namespace
}  // namespace halflight
