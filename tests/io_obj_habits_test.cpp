// What OBJ leaves open, and the stored references decide.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "halflight/base/image.h"
#include "halflight/io/image_write.h"
#include "halflight/io/load_scene.h"
#include "halflight/io/polygon.h"
#include "halflight/scene/geometry.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(Polygon, BentConvexQuadsAreCutFromTheirFirstCorner) {
  Triangles triangles;
  triangulate_polygon(std::vector<Vec3>{{0, 0, 0.1f}, {1, 0, 0}, {1.2f, 1, 0}, {0, 1, 0}},
                      triangles);
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  triangles.clear();
  triangulate_polygon(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.8f, 0.1f, 0}},
                      triangles);
  for (const auto& t : triangles)  // a dart: only the diagonal from corner 1 to 3 runs inside
    EXPECT_EQ(std::count(t.begin(), t.end(), 1u) + std::count(t.begin(), t.end(), 3u), 2);
  EXPECT_EQ(triangles.size(), 2u);
}

TEST(Obj, ATextureStandsInForTheDiffuseColour) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_image(folder.path() / "white.png", Image(1, 1, Rgb(1.f))));
  folder.write("m.mtl", "newmtl a\nKd 0.2 0.3 0.4\nmap_Kd white.png\n");
  const auto file = folder.write("s.obj",
                                 "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
                                 "f 1/1 2/1 3/1\n");
  const auto scene = load_scene(file);
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(reflectance_at(*scene, flatten(*scene), TriangleId(0u), {0.2f, 0.2f}), Rgb(1.f));
}

TEST(Obj, TheDiffuseColourStaysWhereThePictureIsMissing) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl a\nKd 0.2 0.3 0.4\nmap_Kd none.png\n");
  const auto scene = load_scene(
      folder.write("s.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(reflectance_at(*scene, flatten(*scene), TriangleId(0u), {0.2f, 0.2f}),
            Rgb(0.2f, 0.3f, 0.4f));
}

}  // namespace
}  // namespace halflight
