// Files made to break the reader: it must answer with a scene or one line, soon and in little
// memory.
#include <chrono>
#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "gltf_builder.h"
#include "halflight/io/encode_png.h"
#include "halflight/io/load_scene.h"
#include "halflight/io/read_file.h"
#include "halflight/scene/geometry.h"
#include "shared_scenes.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

void expect_one_line(const Result<Scene>& scene) {
  if (scene) return;
  EXPECT_FALSE(scene.error().what.empty());
  EXPECT_THAT(scene.error().what, testing::Not(HasSubstr("\n")));
}

std::string refusal(const TemporaryFolder& folder, const std::string& glb) {
  const Result<Scene> scene = load_scene(folder.write("scene.glb", glb));
  return scene ? "" : scene.error().line();
}

TEST(HostileScene, DeepNestingAndLongChainsOfNodesAreNoTrouble) {
  const TemporaryFolder folder;
  const std::string deep = R"({"asset":{"version":"2.0","extras":)" + std::string(500000, '[') +
                           std::string(500000, ']') + "}}";
  EXPECT_TRUE(load_scene(folder.write("deep.gltf", deep)));
  EXPECT_FALSE(load_scene(folder.write("open.gltf", std::string(500000, '['))));

  GltfBuilder chain;
  chain.add_triangle();
  for (int i = 1; i < 100000; ++i) chain.add("nodes", {{"children", {i - 1}}});
  chain.json["scenes"][0]["nodes"] = {99999};
  const auto scene = load_scene(folder.write("chain.glb", chain.glb()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(flatten(*scene).triangles.size(), 1u);
}

TEST(HostileScene, LightBeyondAllNumbersIsRefused) {
  const TemporaryFolder folder;
  const auto glowing = [](double strength) {
    GltfBuilder lamp;
    lamp.add_triangle(
        {{"emissiveFactor", {1, 1, 1}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", strength}}}}}});
    return lamp.glb();
  };
  EXPECT_EQ(refusal(folder, glowing(1e9)), "");
  EXPECT_THAT(refusal(folder, glowing(1e20)), HasSubstr("too large"));
  EXPECT_THAT(refusal(folder, glowing(-1.0)), HasSubstr("negative"));
  for (const char* light : {"Ke 1 -1 1\n", "Ke 1e20\n"}) {
    folder.write("m.mtl", std::string("newmtl lamp\n") + light);
    const auto scene = load_scene(folder.write("lamp.obj", "mtllib m.mtl\n"));
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->materials[MaterialId(0)].emission, Rgb(0.f));
    EXPECT_THAT(scene->warnings, testing::Contains(HasSubstr("m.mtl:2: 'Ke'")));
  }
}

TEST(HostileScene, SmallFilesThatClaimGigabytesAreRefused) {
  const TemporaryFolder folder;
  GltfBuilder zeros;
  zeros.add_triangle();
  zeros.json["accessors"][0]["count"] = 100000000;
  zeros.json["accessors"][0].erase("bufferView");
  EXPECT_THAT(refusal(folder, zeros.glb()), HasSubstr("without data"));

  GltfBuilder instances;
  instances.add_triangle();
  const auto shift =
      instances.add("accessors", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 16000000}});
  instances.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", shift}};
  EXPECT_THAT(refusal(folder, instances.glb()), HasSubstr("more than"));

  GltfBuilder repeated;
  const auto positions = repeated.add_positions(std::vector<float>(300000, 0.5f));
  json primitives = json::array();
  for (int i = 0; i < 2000; ++i) primitives.push_back({{"attributes", {{"POSITION", positions}}}});
  repeated.add("meshes", {{"primitives", primitives}});
  repeated.add_root({{"mesh", 0}});
  EXPECT_THAT(refusal(folder, repeated.glb()), HasSubstr("vertices"));

  GltfBuilder placed;
  placed.add("meshes",
             {{"primitives",
               {{{"attributes",
                  {{"POSITION", placed.add_positions(std::vector<float>(300000, 0.5f))}}}}}}});
  for (int i = 0; i < 2000; ++i) placed.add_root({{"mesh", 0}});
  EXPECT_THAT(refusal(folder, placed.glb()), HasSubstr("placed vertices"));
}

// Images of the same bytes are one picture, and pictures that lie over each other are counted.
TEST(HostileScene, PicturesAreDecodedOnceAndCounted) {
  const TemporaryFolder folder;
  const std::array<std::uint8_t, 4> texel{1, 2, 3, 255};
  const Bytes picture = encode_png(1, 1, {&texel, 1});
  const auto scene_of = [&](int images, const auto& image) {
    GltfBuilder b;
    b.add_triangle();
    b.json["buffers"] = {{{"byteLength", b.data().size()}}};
    for (int i = 0; i < images; ++i) {
      b.add("images", image(b, i));
      b.add("textures", {{"source", i}});
      json primitive = b.json["meshes"][0]["primitives"][0];
      primitive["material"] =
          b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
      b.json["meshes"][0]["primitives"].push_back(primitive);
    }
    b.json.erase("buffers");
    return b.glb();
  };
  folder.write("texture.png", {reinterpret_cast<const char*>(picture.data()), picture.size()});
  const Result<Scene> named =
      load_scene(folder.write("named.glb", scene_of(3, [](GltfBuilder&, int i) {
                                return json{{"uri", i == 1 ? "./texture.png" : "texture.png"}};
                              })));
  ASSERT_TRUE(named) << named.error().line();
  EXPECT_EQ(named->textures.size(), 1u);

  // Its header claims the largest picture that may be: 16384 x 8192.
  Bytes vast = picture;
  vast.resize(vast.size() + 24);  // views of other lengths
  vast[18] = 0x40, vast[19] = 0, vast[22] = 0x20, vast[23] = 0;
  const auto sum = static_cast<std::uint32_t>(crc32(0, vast.data() + 12, 17));
  for (int i = 0; i < 4; ++i) vast[29 + i] = static_cast<std::uint8_t>(sum >> (24 - 8 * i));
  std::size_t view = 0;
  const std::string bomb = scene_of(24, [&](GltfBuilder& b, int i) {
    if (i == 0) view = b.add_view(vast);
    json part = b.json["bufferViews"][view];
    part["byteLength"] = vast.size() - static_cast<std::size_t>(i);
    return json{{"bufferView", b.add("bufferViews", part)}, {"mimeType", "image/png"}};
  });
  EXPECT_THAT(refusal(folder, bomb), HasSubstr("texels"));
}

TEST(HostileScene, LongNamesAreRefused) {
  const TemporaryFolder folder;
  GltfBuilder b;
  b.add_triangle({{"name", std::string(4096, 'a')}});
  EXPECT_EQ(refusal(folder, b.glb()), "");
  b.json["meshes"][0]["name"] = std::string(4097, 'a');
  EXPECT_THAT(refusal(folder, b.glb()), HasSubstr("meshes/0/name: this has more than 4096 bytes"));
}

TEST(HostileScene, PicturesOutsideTheirBufferAreRefused) {
  const TemporaryFolder folder;
  GltfBuilder gltf;
  gltf.add_triangle({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["images"] = {{{"bufferView", 1}, {"mimeType", "image/png"}}};
  gltf.add("bufferViews", {{"buffer", 0}, {"byteOffset", 1000000000}, {"byteLength", 100}});
  EXPECT_THAT(refusal(folder, gltf.glb()), HasSubstr("bufferViews/1"));
}

// Seconds that it takes to read an OBJ file.
double seconds_to_read(const TemporaryFolder& folder, const std::string& obj) {
  const auto path = folder.write("slow.obj", obj);
  const auto begin = std::chrono::steady_clock::now();
  expect_one_line(load_scene(path));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

constexpr const char* kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(HostileScene, SpacesAtTheEndOfALineAreSkippedOnce) {
  const TemporaryFolder folder;
  EXPECT_LT(seconds_to_read(
                folder, kCorners + ("f " + repeated("1 ", 100'000)) + std::string(300'000, ' ')),
            3.0);
  folder.write("m.mtl",
               "newmtl a\nmap_Kd " + repeated("-x a ", 60'000) + std::string(300'000, ' '));
  EXPECT_LT(seconds_to_read(folder, "mtllib m.mtl\n"), 3.0);
}

TEST(HostileScene, HoursOfCuttingFacesAreRefused) {
  const TemporaryFolder folder;
  const std::string face = "f " + repeated("1 2 3 ", 4095 / 3) + "1\n";
  const auto scene = load_scene(folder.write("slow.obj", kCorners + repeated(face, 65)));
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().line(), HasSubstr("slow.obj:68: too many faces"));
}

// As many discs as a large drawing has.
TEST(HostileScene, ThousandsOfRoundFacesAreRead) {
  const TemporaryFolder folder;
  std::string disc, face = "f";
  for (int i = 0; i < 200; ++i) {
    const double angle = 2.0 * static_cast<double>(kPi) * i / 200.0;
    disc += fmt::format("v {} {} 0\n", std::cos(angle), std::sin(angle));
    face += fmt::format(" {}", i + 1);
  }
  const auto scene = load_scene(folder.write("discs.obj", disc + repeated(face + "\n", 5000)));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(flatten(*scene).triangles.size(), 5000u * 198u);
}

TEST(HostileScene, NamesOfGroupsTakeLittleMemory) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& obj) {
    const auto scene = load_scene(folder.write("named.obj", kCorners + obj));
    return scene ? "" : scene.error().line();
  };
  const std::string name(4096, 'a');
  for (const char* key : {"o ", "g ", "usemtl "}) {
    EXPECT_EQ(refused(key + name + "\nf 1 2 3\n"), "");
    EXPECT_THAT(refused(fmt::format("\n{}{}a\nf 1 2 3\n", key, name)),
                HasSubstr("named.obj:5: a name is longer than 4096 bytes"));
  }
  folder.write("m.mtl", "\nnewmtl " + name + "a\n");
  EXPECT_THAT(refused("mtllib m.mtl\n"), HasSubstr("m.mtl:2: a name is longer than"));
  // Each of the groups would repeat the name of the object.
  std::string groups = "o " + name + "\n";
  for (int i = 0; i < 140'000; ++i) groups += fmt::format("g {}\nf 1 2 3\n", i);
  EXPECT_THAT(refused(groups), HasSubstr("bytes of names"));
}

TEST(HostileScene, MaterialLibrariesAreReadOnce) {
  const TemporaryFolder folder;
  folder.write("m.mtl", repeated("newmtl a\n", 1000));
  const auto scene = load_scene(folder.write(
      "libraries.obj", "mtllib " + repeated("m.mtl ./m.mtl ", 100) + "\nmtllib m.mtl\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->materials.size(), 1000u);
  std::string all = "mtllib";
  for (int i = 0; i < 1025; ++i) all += fmt::format(" {}.mtl", i);
  const auto many = load_scene(folder.write("libraries.obj", all));
  ASSERT_FALSE(many);
  EXPECT_THAT(many.error().line(), HasSubstr("more than 1024 material libraries"));
}

TEST(HostileScene, DevicesAndFoldersAreNotScenes) {
  const TemporaryFolder folder;
  GltfBuilder gltf;
  gltf.add_triangle();
  gltf.json["buffers"] = {{{"byteLength", 36}, {"uri", "../../../../../../../../dev/zero"}}};
  EXPECT_THAT(refusal(folder, gltf.glb()), HasSubstr("not a file"));
  std::filesystem::create_directory(folder.path() / "folder.obj");
  EXPECT_FALSE(load_scene(folder.path() / "folder.obj"));
}

// Cuts, flips and repeats bytes of `original`.
std::string spoiled(const std::string& original, std::mt19937& random) {
  std::string text = original;
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  for (std::size_t i = 1 + below(6); i > 0 && !text.empty(); --i) {
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = "0123456789-,.e[]{}\"/ \n"[below(22)];
        break;
      case 2:
        text.erase(at, 1 + below(8));
        break;
      default:
        text.insert(at, text.substr(below(text.size()), 1 + below(16)));
        break;
    }
  }
  return text;
}

// GLB files are spoiled inside; their header must keep its length to get any further.
void repair_glb_length(std::string& file) {
  if (file.size() < 12) return;
  const auto length = static_cast<std::uint32_t>(file.size());
  std::memcpy(file.data() + 8, &length, sizeof length);
}

TEST(HostileScene, SpoiledSamplesGiveASceneOrOneLine) {
  HALFLIGHT_NEEDS_SHARED_SCENES();
  const TemporaryFolder folder;
  std::mt19937 random(3);
  for (const char* name :
       {"gltf-samples/BoxInterleaved/glTF-Embedded/BoxInterleaved.gltf",
        "gltf-samples/SimpleSparseAccessor/glTF-Embedded/SimpleSparseAccessor.gltf",
        "gltf-samples/BoxVertexColors/glTF-Binary/BoxVertexColors.glb",
        "gltf-samples/Cameras/glTF-Embedded/Cameras.gltf", "obj-samples/tinyobj/cornell_box.obj",
        "obj-samples/assimp/concave_polygon.obj"}) {
    SCOPED_TRACE(name);
    const auto bytes = read_file(shared_scenes() / name);
    ASSERT_TRUE(bytes);
    const std::string original(bytes->begin(), bytes->end());
    const std::string extension = std::filesystem::path(name).extension();
    std::size_t read = 0, refused = 0;
    for (int i = 0; i < 300; ++i) {
      std::string text = spoiled(original, random);
      if (extension == ".glb") repair_glb_length(text);
      const auto scene = load_scene(folder.write("spoiled" + extension, text));
      expect_one_line(scene);
      if (scene) flatten(*scene);
      ++(scene ? read : refused);
    }
    EXPECT_GT(read, 0u);
    if (extension != ".obj") {
      EXPECT_GT(refused, 0u);
    }
  }
}

}  // namespace
}  // namespace halflight
