#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <fmt/format.h>

#include "halflight/io/load_scene.h"
#include "halflight/scene/geometry.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using testing::Contains;
using testing::HasSubstr;

Scene load(const TemporaryFolder& folder, std::string_view obj, const LoadOptions& options = {}) {
  Result<Scene> scene = load_scene(folder.write("scene.obj", obj), options);
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? std::move(*scene) : Scene();
}

constexpr std::string_view kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(Obj, NegativeIndicesCountFromTheVerticesReadSoFar) {
  const TemporaryFolder folder;
  const Geometry g =
      flatten(load(folder, "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 7 7 7\n"));
  ASSERT_EQ(g.triangles.size(), 1u);
  EXPECT_EQ(g.corners(TriangleId(0)), (std::array{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}));
}

TEST(Obj, MaterialsSayReflectanceRadianceAndOpacity) {
  const TemporaryFolder folder;
  folder.write("m.mtl",
               "newmtl lamp with spaces\nKd .1 +0.2 3e-1\nKe 17 12 4\nillum 2\n"
               "newmtl glass\nd 0.25\nTr 0.9\nnewmtl film\nTr 0.75\nnewmtl grey\nKd 0.4\n");
  const Scene scene = load(folder, "mtllib m.mtl\n");
  ASSERT_EQ(scene.materials.size(), 4u);
  const auto& m = scene.materials.raw();
  EXPECT_EQ(m[0].name, "lamp with spaces");
  EXPECT_EQ(m[0].reflectance, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m[0].emission, Rgb(17, 12, 4));
  EXPECT_EQ(m[0].alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(m[1].alpha, 0.25f);
  EXPECT_EQ(m[1].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(m[2].alpha, 0.25f);
  EXPECT_EQ(m[3].reflectance, Rgb(0.4f));
}

// A TGA picture, 1 pixel wide, from the top down, of blue-green-red-alpha pixels.
std::string tga(const std::vector<std::array<std::uint8_t, 4>>& bgra) {
  std::string file(18, '\0');
  file[2] = 2;
  file[12] = 1;
  file[14] = static_cast<char>(bgra.size());
  file[16] = 32;
  file[17] = 0x28;
  for (const auto& pixel : bgra)
    for (const std::uint8_t c : pixel) file += static_cast<char>(c);
  return file;
}

constexpr std::string_view kTopOfPicture =
    "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.9\nf 1/1 2/1 3/1\n";

TEST(Obj, TextureCoordinatesCountFromTheBottomOfThePicture) {
  const TemporaryFolder folder;
  folder.write("red over blue.tga", tga({{0, 0, 255, 255}, {255, 0, 0, 255}}));
  folder.write("m.mtl", "newmtl a\nmap_Kd -clamp on red over blue.tga\n");
  const Scene scene = load(folder, kTopOfPicture);
  EXPECT_EQ(reflectance_at(scene, flatten(scene), TriangleId(0), {0.2f, 0.2f}), Rgb(1, 0, 0));
  // Shifted to 0.9 + 0.35, the corners repeat to 0.25: the middle of the lower pixel.
  folder.write("m.mtl", "newmtl a\nmap_Kd -s 1 1 -o 0 0.35 red over blue.tga\n");
  const Scene moved = load(folder, kTopOfPicture);
  EXPECT_LT(glm::distance(reflectance_at(moved, flatten(moved), TriangleId(0), {0.2f, 0.2f}),
                          Rgb(0, 0, 1)),
            1e-5f);
}

TEST(Obj, PicturesMovedBeyondAllNumbersStayWhereTheyAre) {
  const TemporaryFolder folder;
  folder.write("red.tga", tga({{0, 0, 255, 255}}));
  for (const char* map : {"-s 1 3e38 -o 0 3e38", "-o -2e6", "-s 2e6"}) {
    folder.write("m.mtl", fmt::format("newmtl a\nmap_Kd {} red.tga\n", map));
    const Scene scene = load(folder, kTopOfPicture);
    EXPECT_EQ(scene.materials.raw()[0].reflectance_texture.uv_transform, TextureRef().uv_transform);
    EXPECT_TRUE(scene.materials.raw()[0].reflectance_texture.valid());
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("red.tga is scaled or moved")));
  }
}

TEST(Obj, OpacityMapsAreGreyOrTheAlphaOfAPicture) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl a\nmap_d mask.tga\n");
  folder.write("mask.tga", tga({{51, 51, 51, 255}}));
  const Scene grey = load(folder, kTopOfPicture);
  EXPECT_FLOAT_EQ(opacity_at(grey, flatten(grey), TriangleId(0), {0.2f, 0.2f}), 0.2f);
  folder.write("mask.tga", tga({{255, 255, 255, 102}}));
  const Scene alpha = load(folder, kTopOfPicture);
  EXPECT_FLOAT_EQ(opacity_at(alpha, flatten(alpha), TriangleId(0), {0.2f, 0.2f}), 0.4f);
}

TEST(Obj, MissingFilesAndMaterialsAreWarnings) {
  const TemporaryFolder folder;
  const Scene scene = load(folder, "mtllib none.mtl\nusemtl wall\n" + std::string(kTriangle));
  EXPECT_EQ(flatten(scene).triangles.size(), 1u);
  EXPECT_EQ(scene.materials.raw()[0].name, "wall");
  EXPECT_EQ(scene.materials.raw()[0].reflectance, Rgb(0.5f));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("none.mtl: there is no such file")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("'wall'")));
}

TEST(Obj, FacesWithUnreadableOrMissingVerticesAreLeftOutAndCounted) {
  const TemporaryFolder folder;
  const Scene scene = load(folder, std::string(kTriangle) +
                                       "v nan 0 0\nv 1 bleh 2\nv 1e99 0 0\nv 1 2\n"
                                       "f 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 2 0\nf 1 2 8\n"
                                       "f 1 2 -99\nf 1 2\nf 1 2 99999999999999999999\n");
  EXPECT_EQ(flatten(scene).triangles.size(), 1u);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("scene.obj:9: a face is left out")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("(9 in all)")));
}

TEST(Obj, ObjectsAndGroupsBecomeNamedNodesAndMaterialsPrimitives) {
  const TemporaryFolder folder;
  const Scene scene = load(folder,
                           "v 0 0 0\nv 1 0 0\nv 0 1 0\no desk\nusemtl wood\nf 1 2 3\n"
                           "g leg\nf 1 2 3\nusemtl steel\nf 1 2 3\nusemtl wood\nf 1 2 3\n"
                           "o lamp\nf 1 2 3\n");
  ASSERT_EQ(scene.nodes.size(), 3u);
  EXPECT_EQ(scene.nodes.raw()[0].name, "desk");
  EXPECT_EQ(scene.nodes.raw()[1].name, "desk/leg");
  EXPECT_EQ(scene.nodes.raw()[2].name, "lamp");
  ASSERT_EQ(scene.meshes.raw()[1].primitives.size(), 2u);
  EXPECT_EQ(scene.meshes.raw()[1].primitives[0].triangles.size(), 2u);
}

TEST(Obj, UnitAndUpAxisLeadToMetresWithYUp) {
  const TemporaryFolder folder;
  const Geometry g = flatten(load(folder, "v 100 0 0\nv 0 200 0\nv 0 0 300\nf 1 2 3\n",
                                  {.metres_per_unit = 0.01, .up = UpAxis::z}));
  const auto [x, y, z] = g.corners(TriangleId(0));
  EXPECT_LT(glm::distance(x, Vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::distance(y, Vec3(0, 0, -2)), 1e-6f);
  EXPECT_LT(glm::distance(z, Vec3(0, 3, 0)), 1e-6f);
}

TEST(Obj, LongFacesAndJoinedLinesKeepAllTheirCorners) {
  const TemporaryFolder folder;
  const int n = 300;
  std::string obj, face = "f";
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * static_cast<double>(kPi) * i / n;
    obj += fmt::format("v {} {} 0\r\n", std::cos(angle), std::sin(angle));
    face += fmt::format(" {}{}", i + 1, i % 50 == 49 ? " \\\r\n" : "");
  }
  const Geometry g = flatten(load(folder, obj + face));
  EXPECT_EQ(g.triangles.size(), static_cast<std::size_t>(n - 2));
  double area = 0.0;
  for (std::size_t i = 0; i < g.triangles.size(); ++i)
    area += 0.5 * static_cast<double>(g.scaled_normal(TriangleId(i)).z);
  EXPECT_NEAR(area, 0.5 * n * std::sin(2.0 * static_cast<double>(kPi) / n), 1e-4);
}

TEST(Obj, CornersShareAVertexOnlyWhenAllTheirIndicesAgree) {
  const TemporaryFolder folder;
  const Scene scene = load(folder,
                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 0 1 0\n"
                           "f 1//1 2//1 3//1\nf 3//1 2//2 4\n");
  const Primitive& p = scene.meshes.raw()[0].primitives[0];
  EXPECT_EQ(p.positions.size(), 5u);  // 2//1 and 2//2 differ
  EXPECT_EQ(p.normals.size(), 5u);
  EXPECT_EQ(p.normals[4], Vec3(0.f));  // none given
}

}  // namespace
}  // namespace halflight
