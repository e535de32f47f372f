#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "halflight/io/load_scene.h"
#include "halflight/scene/geometry.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Scene load(const GltfBuilder& gltf) {
  const TemporaryFolder folder;
  Result<Scene> scene = load_scene(folder.write("scene.glb", gltf.glb()));
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? std::move(*scene) : Scene();
}

std::string refusal(const GltfBuilder& gltf) {
  const TemporaryFolder folder;
  const Result<Scene> scene = load_scene(folder.write("scene.glb", gltf.glb()));
  return scene ? "" : scene.error().line();
}

Material first_material(const json& material) {
  GltfBuilder gltf;
  gltf.add_triangle(material);
  return load(gltf).materials.raw().at(0);
}

TEST(Gltf, StripsAndFansFaceTheWayTheirFirstTriangleDoes) {
  for (const int mode : {5, 6}) {
    GltfBuilder gltf;
    const auto positions = mode == 5
                               ? gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0})
                               : gltf.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0});
    gltf.add_root(
        {{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"mode", mode}})}});
    const Geometry g = flatten(load(gltf));
    ASSERT_EQ(g.triangles.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(g.scaled_normal(TriangleId(i)).z, 0.f);
  }
}

TEST(Gltf, NormalizedIntegersAreFractionsOfTheirLargestValue) {
  GltfBuilder gltf;
  const auto positions =
      gltf.add_accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 0, -32768, 0}, 5122, "VEC3", 3, true);
  const auto uvs = gltf.add_accessor<std::uint8_t>({0, 255, 51, 0, 0, 0}, 5121, "VEC2", 2, true);
  gltf.add_root(
      {{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}})}});
  const Scene scene = load(gltf);
  const Primitive& p = scene.meshes.raw()[0].primitives[0];
  EXPECT_EQ(p.positions[1], Vec3(1, 0, 0));
  EXPECT_EQ(p.positions[2], Vec3(0, -1, 0));
  EXPECT_EQ(p.uvs[0][0], Vec2(0, 1));
  EXPECT_EQ(p.uvs[0][1], Vec2(0.2f, 0));
}

TEST(Gltf, NodesComposeTransformsAndMirroringKeepsFrontsInFront) {
  GltfBuilder gltf;
  gltf.add_triangle();
  gltf.json["nodes"][0]["scale"] = {-1, 1, 1};
  gltf.json["nodes"][0]["translation"] = {0, 0, 5};
  const float half = std::sqrt(0.5f);  // a quarter turn about z
  const auto parent = gltf.add("nodes", {{"rotation", {0, 0, half, half}}, {"children", {0}}});
  gltf.json["scenes"][0]["nodes"] = {parent};
  const Geometry g = flatten(load(gltf));
  // (1, 0, 0) is mirrored to (-1, 0, 0), then turned to (0, -1, 0).
  EXPECT_TRUE(g.bounds.contains(Vec3(0, -0.999f, 5)));
  EXPECT_TRUE(g.bounds.contains(Vec3(-0.999f, 0, 5)));
  EXPECT_GT(g.scaled_normal(TriangleId(0)).z, 0.f);
}

TEST(Gltf, EmissionIsFactorTimesStrength) {
  const Material m = first_material(
      {{"emissiveFactor", {1, 0.5, 0}},
       {"doubleSided", true},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 40}}}}}});
  EXPECT_EQ(m.emission, Rgb(40, 20, 0));
  EXPECT_TRUE(m.double_sided);
}

TEST(Gltf, BaseColourDiffuseFactorOrWhiteIsTheReflectance) {
  const Material metal = first_material(
      {{"name", "steel"},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0.125, 0.75}}}},
       {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}}}});
  EXPECT_EQ(metal.reflectance, Rgb(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(metal.alpha, 0.75f);
  EXPECT_EQ(metal.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(metal.alpha_cutoff, 0.25f);
  EXPECT_EQ(metal.transmission, 0.5f);
  const Material old = first_material(
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 1}}}}}}});
  EXPECT_EQ(old.reflectance, Rgb(0.1f, 0.2f, 0.3f));
  GltfBuilder bare;
  bare.add_triangle();
  EXPECT_EQ(load(bare).materials.raw().at(0).reflectance, Rgb(1.f));
}

TEST(Gltf, InstancesArePlacedByTheirAttributes) {
  GltfBuilder gltf;
  gltf.add_triangle();
  const auto shift = gltf.add_positions({0, 0, 0, 10, 0, 0, 0, 0, 20});
  const auto size = gltf.add_positions({1, 1, 1, 2, 2, 2, 1, 1, 1});
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", shift}, {"SCALE", size}};
  const Geometry g = flatten(load(gltf));
  ASSERT_EQ(g.triangles.size(), 3u);
  EXPECT_EQ(g.corners(TriangleId(1))[1], Vec3(12, 0, 0));
  EXPECT_EQ(g.corners(TriangleId(2))[0], Vec3(0, 0, 20));
}

TEST(Gltf, LightsAndCamerasHangOnTheirNodes) {
  GltfBuilder gltf;
  gltf.add_triangle();
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"color", {1, 0.5, 0}},
       {"intensity", 100},
       {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}}};
  gltf.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"aspectRatio", 1.5}}}}};
  json node = {{"name", "desk lamp"}, {"translation", {0, 3, 0}}, {"camera", 0}};
  node["rotation"] = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // -z turns to -y
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  gltf.add_root(node);
  const Geometry g = flatten(load(gltf));
  ASSERT_EQ(g.lights.size(), 1u);
  EXPECT_EQ(g.lights[0].kind, Light::Kind::spot);
  EXPECT_EQ(g.lights[0].intensity, Rgb(100, 50, 0));
  EXPECT_EQ(g.lights[0].position, Vec3(0, 3, 0));
  EXPECT_LT(glm::distance(g.lights[0].direction, Vec3(0, -1, 0)), 1e-6f);
  EXPECT_FLOAT_EQ(g.lights[0].cos_outer, std::cos(0.5f));
  ASSERT_EQ(g.cameras.size(), 1u);
  EXPECT_EQ(g.cameras[0].name, "desk lamp");
  EXPECT_FLOAT_EQ(g.cameras[0].vertical_fov, 0.6f);
}

// The rotation of the extension is counter-clockwise as seen on a picture whose v points down: a
// quarter turn takes the direction u to the direction -v.
TEST(Gltf, TextureTransformScalesThenTurnsThenShifts) {
  GltfBuilder gltf;
  gltf.json["images"] = {{{"uri", "none.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.add_triangle({{"pbrMetallicRoughness",
                      {{"baseColorTexture",
                        {{"index", 0},
                         {"extensions",
                          {{"KHR_texture_transform",
                            {{"rotation", std::acos(0.0)},
                             {"scale", {2, 3}},
                             {"offset", {0.25, 0.5}},
                             {"texCoord", 1}}}}}}}}}});
  const TextureRef ref = load(gltf).materials.raw()[0].reflectance_texture;
  EXPECT_EQ(ref.uv_set, 1);
  const std::array<float, 6> expected = {0, 3, 0.25f, -2, 0, 0.5f};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(ref.uv_transform[i], expected[i], 1e-6f);
}

TEST(Gltf, VerticesThatAreNotFiniteTakeTheirTrianglesWithThem) {
  GltfBuilder gltf;
  const auto positions =
      gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, std::nanf(""), 0, 0, 1, 0, 0, 0, 1, 0});
  gltf.add_root({{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  const Scene scene = load(gltf);
  EXPECT_EQ(scene.meshes.raw()[0].primitives[0].triangles.size(), 1u);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(Gltf, AnUnknownRequiredExtensionIsNamed) {
  GltfBuilder gltf;
  gltf.add_triangle();
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization", "ACME_voxels"};
  EXPECT_THAT(refusal(gltf), HasSubstr("extensionsRequired/1"));
  EXPECT_THAT(refusal(gltf), HasSubstr("ACME_voxels"));
}

TEST(Gltf, SeparateFilesMayHaveEscapedNames) {
  GltfBuilder gltf;
  gltf.add_triangle();
  gltf.json["buffers"] = {{{"byteLength", gltf.data().size()}, {"uri", "my%20data.bin"}}};
  const TemporaryFolder folder;
  folder.write("my data.bin",
               {reinterpret_cast<const char*>(gltf.data().data()), gltf.data().size()});
  const auto scene = load_scene(folder.write("scene.gltf", gltf.json.dump()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(flatten(*scene).triangles.size(), 1u);
}

TEST(Gltf, MistakesAreReportedWithTheirPlace) {
  const auto refusal_after = [](const auto& spoil) {
    GltfBuilder gltf;
    gltf.add_triangle();
    const auto indices = gltf.add_accessor<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
    gltf.json["meshes"][0]["primitives"][0]["indices"] = indices;
    spoil(gltf.json);
    return refusal(gltf);
  };
  const auto no_change = [](json&) {};
  EXPECT_EQ(refusal_after(no_change), "");
  EXPECT_THAT(refusal_after([](json& j) { j["accessors"][0]["count"] = 4; }),
              HasSubstr("accessors/0: the elements reach beyond their buffer view"));
  EXPECT_THAT(refusal_after([](json& j) { j["accessors"][0]["count"] = 4294967295u; }),
              HasSubstr("more than 134217728 vertices"));
  EXPECT_THAT(refusal_after([](json& j) { j["bufferViews"][0]["byteStride"] = 8; }),
              HasSubstr("accessors/0: byteStride"));
  EXPECT_THAT(refusal_after([](json& j) { j["bufferViews"][0]["byteOffset"] = 1e15; }),
              HasSubstr("bufferViews/0: the buffer view reaches beyond"));
  EXPECT_THAT(refusal_after([](json& j) { j["bufferViews"][0]["buffer"] = 1; }),
              HasSubstr("bufferViews/0/buffer: there is no buffers 1"));
  EXPECT_THAT(refusal_after([](json& j) { j["accessors"][0]["byteOffset"] = -4; }),
              HasSubstr("accessors/0/byteOffset"));
  EXPECT_THAT(refusal_after([](json& j) { j["accessors"][1]["componentType"] = 5126; }),
              HasSubstr("accessors/1: indices should be"));
  EXPECT_THAT(refusal_after([](json& j) { j["nodes"][0]["children"] = {0}; }),
              HasSubstr("nodes: the nodes form a circle"));
  EXPECT_THAT(refusal_after([](json& j) {
                j["nodes"][0]["matrix"] = {1, 2};
              }),
              HasSubstr("nodes/0/matrix"));
  EXPECT_THAT(refusal_after([](json& j) { j["meshes"][0]["primitives"][0]["material"] = "x"; }),
              HasSubstr("primitives/0/material: this should be a number"));
  EXPECT_THAT(refusal_after([](json& j) {
                j["buffers"] = {{{"byteLength", 1000}}};
              }),
              HasSubstr("buffers/0: the buffer should have 1000 bytes"));
}

TEST(Gltf, MistakesInMaterialsAreReportedWithTheirPlace) {
  const auto with = [](const json& material, const json& sampler) {
    GltfBuilder gltf;
    gltf.json["images"] = {{{"uri", "none.png"}}};
    gltf.json["samplers"] = {sampler};
    gltf.json["textures"] = {{{"source", 0}, {"sampler", 0}}, json::object()};
    gltf.add_triangle(material);
    return gltf;
  };
  const auto textured = [](const json& info) {
    return json{{"pbrMetallicRoughness", {{"baseColorTexture", info}}}};
  };
  const json plain = json::object();
  EXPECT_THAT(refusal(with({{"alphaMode", "FOIL"}}, plain)),
              HasSubstr("materials/0/alphaMode: 'FOIL' is not an alpha mode"));
  EXPECT_THAT(refusal(with(textured({{"index", 0}}), {{"wrapS", 1}})),
              HasSubstr("samplers/0/wrapS: this is not a wrap mode"));
  EXPECT_THAT(refusal(with({{"emissiveFactor", {-1, 0, 0}}}, plain)),
              HasSubstr("materials/0: the emission is negative"));
  EXPECT_THAT(refusal(with(textured({{"index", 2}}), plain)), HasSubstr("there is no textures 2"));

  const Scene mirrored = load(with(textured({{"index", 0}}), {{"wrapS", 33648}, {"wrapT", 33071}}));
  EXPECT_EQ(mirrored.textures.raw()[0].wrap_u, Wrap::mirror);
  EXPECT_EQ(mirrored.textures.raw()[0].wrap_v, Wrap::clamp);
  // What cannot be used is left out and told.
  for (const json& info : {json{{"index", 0}, {"texCoord", 2}}, json{{"index", 1}}}) {
    const Scene scene = load(with(textured(info), plain));
    EXPECT_FALSE(scene.materials.raw()[0].reflectance_texture.valid());
    EXPECT_THAT(scene.warnings, ::testing::Contains(HasSubstr("ignored")));
  }
}

}  // namespace
}  // namespace halflight
