// The readers against files that other programs wrote, with counts from other readers.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "halflight/io/load_scene.h"
#include "halflight/scene/geometry.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

std::size_t placed_triangles(const Scene& scene) {
  std::size_t n = 0;
  for (const Node& node : scene.nodes) {
    if (!node.mesh.valid()) continue;
    for (const Primitive& p : scene.meshes[node.mesh].primitives)
      n += p.triangles.size() * std::max<std::size_t>(1, node.instances.size());
  }
  return n;
}

std::size_t mesh_nodes(const Scene& scene) {
  std::size_t n = 0;
  for (const Node& node : scene.nodes) n += node.mesh.valid() ? 1 : 0;
  return n;
}

TEST(LoadScene, GltfSamplesHaveTheirCounts) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const fs::path folder = shared_scenes() / "gltf-samples";
  const nlohmann::json listed = read_json(folder / "expected.json");
  for (const auto& [name, expected] : listed.items()) {
    SCOPED_TRACE(name);
    const Result<Scene> scene = load_scene(folder / name);
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(placed_triangles(*scene), expected["triangles"]);
    EXPECT_EQ(mesh_nodes(*scene), expected["mesh_nodes"]);
  }
}

TEST(LoadScene, ObjSamplesHaveTheirCounts) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const fs::path folder = shared_scenes() / "obj-samples";
  const nlohmann::json listed = read_json(folder / "expected.json");
  for (const auto& [name, expected] : listed.items()) {
    SCOPED_TRACE(name);
    const Result<Scene> scene = load_scene(folder / name);
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(placed_triangles(*scene), expected["triangles_n_minus_2"]);
  }
}

TEST(LoadScene, ClutterHasItsCountsAndBounds) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const fs::path folder = shared_scenes() / "clutter";
  const nlohmann::json listed = read_json(folder / "expected.json");
  for (const auto& [name, expected] : listed.items()) {
    SCOPED_TRACE(name);
    const Result<Scene> scene = load_scene(folder / name);
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(placed_triangles(*scene), expected["triangles"]);
    Bounds3f bounds;
    for (const Mesh& mesh : scene->meshes)
      for (const Primitive& p : mesh.primitives)
        for (const Vec3& position : p.positions) bounds.extend(position);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(bounds.lower[k], expected["bbox"][0][k], 1e-3);
      EXPECT_NEAR(bounds.upper[k], expected["bbox"][1][k], 1e-3);
    }
  }
}

// pi * sum of A * L over the front sides.
Rgb emitted_power(const Scene& scene, const Geometry& g) {
  glm::dvec3 power(0.0);
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    const Rgb radiance = scene.materials[g.materials[t]].emission;
    power += glm::dvec3(kPi * 0.5f * glm::length(g.scaled_normal(t)) * radiance);
  }
  return Rgb(power);
}

TEST(LoadScene, ScenesHaveTheirTrianglesAndEmittedPower) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  std::size_t scenes = 0;
  for (const fs::path& path : scene_files(shared_scenes())) {
    SCOPED_TRACE(path.filename());
    const Result<Scene> scene = load_scene(path);
    ASSERT_TRUE(scene) << scene.error().line();
    const nlohmann::json expected = read_json(path.parent_path() / "camera.json");
    EXPECT_EQ(placed_triangles(*scene), expected["triangles"]);
    ++scenes;
    if (!expected.contains("power_pi_A_L_rgb")) continue;
    const Rgb power = emitted_power(*scene, flatten(*scene));
    for (int k = 0; k < 3; ++k) {
      const float stated = expected["power_pi_A_L_rgb"][static_cast<std::size_t>(k)];
      EXPECT_NEAR(power[k], stated, 0.01f * stated);
    }
  }
  EXPECT_EQ(scenes, 14u);
}

// Reflectance of the surface nearest to a point in the plane of the sample's quads.
float brightness_at(const Scene& scene, const Geometry& g, Vec3 point) {
  float nearest = kInfinity, found = -1.f;
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const auto [a, b, c] = g.corners(TriangleId(i));
    for (int u = 0; u <= 64; ++u)
      for (int v = 0; u + v <= 64; ++v) {
        const Vec2 bary(static_cast<float>(u) / 64.f, static_cast<float>(v) / 64.f);
        const Vec3 at = a + bary.x * (b - a) + bary.y * (c - a);
        if (glm::distance(at, point) >= nearest) continue;
        nearest = glm::distance(at, point);
        found = average(reflectance_at(scene, g, TriangleId(i), bary));
      }
  }
  return found;
}

// Khronos' test asset: the quad shows a black arrow from its upper left corner, which must point at
// the mark for readers that turn the right way, 67.5 degrees downwards.
TEST(LoadScene, TurnedTexturesPointAtTheMarkOfTheTestAsset) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const auto scene =
      load_scene(shared_scenes() / "gltf-samples/textureTransform/TextureTransformTest.gltf");
  ASSERT_TRUE(scene) << scene.error().line();
  const Geometry g = flatten(*scene);
  const Vec3 corner(-1.1f - 0.5f, -0.55f + 0.5f, 0.f);
  const auto along = [&](float degrees) {
    const float angle = degrees * kPi / 180.f;
    return brightness_at(*scene, g, corner + 0.6f * Vec3(std::cos(angle), -std::sin(angle), 0.f));
  };
  EXPECT_LT(along(67.5f), 0.1f);
  EXPECT_GT(along(45.f), 0.5f);
  EXPECT_GT(along(22.5f), 0.5f);
}

TEST(LoadScene, BadFilesAreRefusedOrToleratedAsListed) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  std::ifstream manifest(shared_scenes() / "bad" / "MANIFEST.tsv");
  std::size_t files = 0;
  for (std::string line; std::getline(manifest, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    std::string name, source, expectation;
    std::getline(fields, name, '\t');
    std::getline(fields, source, '\t');
    std::getline(fields, expectation, '\t');
    SCOPED_TRACE(name);
    const Result<Scene> scene = load_scene(shared_scenes() / "bad" / name);
    ++files;
    if (scene) {
      EXPECT_NE(expectation, "reject");
      flatten(*scene);
      continue;
    }
    EXPECT_THAT(scene.error().where, testing::HasSubstr("bad/"));
    EXPECT_FALSE(scene.error().what.empty());
    EXPECT_FALSE(scene.error().remedy.empty());
    EXPECT_THAT(scene.error().line(), testing::Not(testing::HasSubstr("\n")));
  }
  EXPECT_EQ(files, 64u);
}

}  // namespace
}  // namespace halflight
