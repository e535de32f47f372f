#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "gltf_check.h"
#include "halflight/io/load_scene.h"
#include "halflight/io/write_gltf.h"
#include "halflight/scene/geometry.h"

namespace halflight {
namespace {

Primitive unit_square(MaterialId material) {
  Primitive p;
  p.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  p.normals.assign(4, Vec3(0, 0, 1));
  p.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.material = material;
  return p;
}

// One of everything a scene can hold.
Scene rich_scene() {
  Scene s;
  Texture t;
  t.name = "checks";
  t.width = t.height = 2;
  t.texels = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 0}};
  t.wrap_u = Wrap::mirror;
  const TextureId checks = s.textures.push_back(t);
  Material paper;
  paper.name = "paper";
  paper.reflectance_texture = {checks, 0, {2, 0, 0.25f, 0, 3, 0.5f}};
  paper.alpha_mode = AlphaMode::mask;
  paper.alpha_texture = {checks, 0, {1, 0, 0, 0, 1, 0}};
  Material lamp;
  lamp.name = "lamp";
  lamp.emission = {20, 10, 5};
  lamp.emission_texture = {checks, 1, {1, 0, 0, 0, 1, 0}};
  lamp.double_sided = true;
  Material glass;
  glass.name = "glass";
  glass.transmission = 0.9f;
  glass.alpha = 0.5f;
  glass.alpha_mode = AlphaMode::blend;
  const MaterialId materials[] = {s.materials.push_back(paper), s.materials.push_back(lamp),
                                  s.materials.push_back(glass)};
  Mesh mesh{"square", {}};
  for (const MaterialId m : materials) mesh.primitives.push_back(unit_square(m));
  const MeshId square = s.meshes.push_back(mesh);
  s.meshes.push_back(Mesh{"nothing", {}});

  Light sun;
  sun.kind = Light::Kind::directional;
  sun.intensity = {100, 90, 80};
  Light spot;
  spot.kind = Light::Kind::spot;
  spot.name = "spot";
  spot.intensity = {0.5f, 0.5f, 0.25f};
  spot.range = 4;
  const LightId lights[] = {s.lights.push_back(sun), s.lights.push_back(spot)};
  Camera flat;
  flat.perspective = false;
  const CameraId cameras[] = {s.cameras.push_back(Camera{"eye"}), s.cameras.push_back(flat)};

  Node root;
  root.name = "root";
  root.camera = cameras[0];
  const NodeId r = s.nodes.push_back(root);
  Node placed;
  placed.name = "placed \xff";  // not UTF-8
  placed.parent = r;
  placed.mesh = square;
  placed.light = lights[0];
  placed.camera = cameras[1];
  placed.local = glm::rotate(glm::translate(Mat4(1.0), glm::dvec3(1, 2, 3)), 0.7,
                             glm::normalize(glm::dvec3(1, 2, -1)));
  s.nodes.push_back(placed);
  Node many;
  many.name = "many";
  many.mesh = square;
  many.light = lights[1];
  many.instances = {glm::translate(Mat4(1.0), glm::dvec3(5, 0, 0)),
                    glm::scale(Mat4(1.0), glm::dvec3(-1, 2, 1))};
  s.nodes.push_back(many);
  Node empty;
  empty.name = "empty mesh";
  empty.mesh = MeshId(1);
  s.nodes.push_back(empty);
  s.sky = {1, 2, 3};
  s.to_world = glm::scale(Mat4(1.0), glm::dvec3(0.01));
  return s;
}

TEST(WriteSceneGlb, EverythingASceneHoldsIsValidGltf) {
  if (!test::have_gltf_validator()) GTEST_SKIP() << "node or the glTF validator is not installed";
  const auto file = test::temporary_file("scene.glb");
  const auto written = write_scene_glb(file, rich_scene());
  ASSERT_TRUE(written) << written.error().line();
  EXPECT_TRUE(test::is_valid_gltf(file));
  std::filesystem::remove(file);
}

TEST(WriteSceneGlb, EmissionAboveOneGoesToTheStrengthExtension) {
  const auto file = test::temporary_file("strength.glb");
  ASSERT_TRUE(write_scene_glb(file, rich_scene()));
  const auto lamp = test::GlbFile(file).document["materials"][1];
  const float strength =
      lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"].get<float>();
  const auto factor = lamp["emissiveFactor"].get<std::vector<float>>();
  const float expected[] = {20, 10, 5};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_LE(factor[c], 1.f);
    EXPECT_FLOAT_EQ(factor[c] * strength, expected[c]);
  }
  std::filesystem::remove(file);
}

// Instancing has no shear: such copies become nodes of their own.
TEST(WriteSceneGlb, ShearedCopiesStayWhereTheyAre) {
  Scene s;
  const MeshId square = s.meshes.push_back({"square", {unit_square(s.materials.push_back({}))}});
  Mat4 sheared(1.0);
  sheared[1][0] = 0.5;
  sheared[3][2] = 3.0;
  Node many;
  many.mesh = square;
  many.instances = {glm::translate(Mat4(1.0), glm::dvec3(0, 0, 1)), sheared};
  s.nodes.push_back(many);
  const auto file = test::temporary_file("sheared.glb");
  ASSERT_TRUE(write_scene_glb(file, s));
  const auto back = load_scene(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(back) << back.error().line();
  const Geometry written = flatten(s), read = flatten(*back);
  ASSERT_EQ(read.positions.size(), written.positions.size());
  for (const Vec3& p : written.positions)
    EXPECT_EQ(std::count(read.positions.begin(), read.positions.end(), p), 1)
        << p.x << ' ' << p.y << ' ' << p.z;
}

TEST(WriteSceneGlb, AFolderThatIsNotThereIsASystemError) {
  const auto written = write_scene_glb("/nonexistent-folder/scene.glb", rich_scene());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, Error::Kind::system);
  EXPECT_NE(written.error().line().find("/nonexistent-folder/scene.glb"), std::string::npos);
}

TEST(WriteSceneGlb, AnEmptySceneIsValidGltf) {
  if (!test::have_gltf_validator()) GTEST_SKIP() << "node or the glTF validator is not installed";
  const auto file = test::temporary_file("empty.glb");
  ASSERT_TRUE(write_scene_glb(file, Scene()));
  EXPECT_TRUE(test::is_valid_gltf(file));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace halflight
