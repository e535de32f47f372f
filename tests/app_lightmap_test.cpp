// --lightmap from outside: files, threads, checkpoints, bad sizes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gltf_check.h"
#include "halflight/io/image_read.h"
#include "room_command.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

class LightmapCommand : public RoomCommand {
 protected:
  static constexpr const char* kSolve = "solve room.obj --feature-size 50cm --progress none ";
};

TEST_F(LightmapCommand, WritesTheSameBytesWhateverTheThreads) {
  for (const char* threads : {"1", "2"})
    ASSERT_EQ(
        run(fmt::format("{} --threads {} --lightmap 128 -o {}.glb", kSolve, threads, threads)), 0)
        << text("err");
  EXPECT_GT(text("1.lightmap.exr").size(), 10'000u);
  EXPECT_GT(text("1.lightmap.png").size(), 1000u);
  EXPECT_EQ(text("1.lightmap.exr"), text("2.lightmap.exr"));
  EXPECT_EQ(text("1.lightmap.png"), text("2.lightmap.png"));
  EXPECT_NE(text("1.glb").find("1.lightmap.exr"), std::string::npos);
}

TEST_F(LightmapCommand, ComesFromACheckpointWithoutSolvingAgain) {
  ASSERT_EQ(run(std::string(kSolve) + "--checkpoint c --lightmap 64 -o lit.glb"), 0) << text("err");
  const std::string lit = text("lit.glb"), map = text("lit.lightmap.exr");
  for (const char* name : {"lit.glb", "lit.lightmap.exr", "lit.lightmap.png"})
    std::filesystem::remove(path(name));
  ASSERT_EQ(run("sample c --lightmap 64 -o lit.glb"), 0) << text("err");
  EXPECT_EQ(text("lit.glb"), lit);
  EXPECT_EQ(text("lit.lightmap.exr"), map);
}

TEST_F(LightmapCommand, LitSceneIsValidGltf) {
  if (!test::have_gltf_validator()) GTEST_SKIP() << "the glTF validator is not installed";
  ASSERT_EQ(run(std::string(kSolve) + "--lightmap 64 -o lit.glb"), 0);
  EXPECT_TRUE(test::is_valid_gltf(path("lit.glb")));
  const test::GlbFile file(path("lit.glb"));
  for (const auto& mesh : file.document["meshes"])
    for (const auto& primitive : mesh["primitives"])
      EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_1"));
}

// In a lightmap of a room the light of sensors on its floor is found at their texels.
TEST_F(LightmapCommand, ShowsWhatSensorsRead) {
  ASSERT_EQ(run(std::string(kSolve) +
                "--lightmap 256 -o lit.glb --points sensors.txt --points-out out.txt"),
            0);
  const auto picture = read_float_image(path("lit.lightmap.exr"));
  ASSERT_TRUE(picture);
  const test::GlbFile file(path("lit.glb"));
  const auto& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
  const auto positions = file.floats(attributes["POSITION"]),
             normals = file.floats(attributes["NORMAL"]),
             uvs = file.floats(attributes["TEXCOORD_1"]);
  const auto indices = file.indices(file.document["meshes"][0]["primitives"][0]["indices"]);
  std::istringstream lines(text("out.txt"));
  std::size_t found = 0;
  for (float x, y, z, nx, ny, nz, r, g, b; lines >> x >> y >> z >> nx >> ny >> nz >> r >> g >> b;) {
    const Vec3 sensor(x, y, z);
    for (std::size_t i = 0; i < indices.size() && ny == 1.f; i += 3) {
      std::array<Vec3, 3> p{};
      std::array<Vec2, 3> uv{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = indices[i + k];
        p[k] = {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
        uv[k] = {uvs[2 * v], uvs[2 * v + 1]};
      }
      const Vec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
      if (normals[3 * indices[i] + 1] < 0.99f || std::abs(p[0].y - y) > 1e-4f) continue;
      const float w1 = glm::dot(glm::cross(sensor - p[0], p[2] - p[0]), n) / glm::dot(n, n);
      const float w2 = glm::dot(glm::cross(p[1] - p[0], sensor - p[0]), n) / glm::dot(n, n);
      if (w1 < 0.f || w2 < 0.f || w1 + w2 > 1.f) continue;
      const Vec2 at = 256.f * (uv[0] + w1 * (uv[1] - uv[0]) + w2 * (uv[2] - uv[0]));
      const Rgb shown = picture->at(static_cast<int>(at.x), static_cast<int>(at.y));
      EXPECT_NEAR(shown.g / g, 1.f, 0.06f) << x << " " << y << " " << z;
      ++found;
      break;
    }
  }
  EXPECT_GE(found, 8u);
}

TEST_F(LightmapCommand, RejectsBadUseInOneLine) {
  for (const char* size :
       {"0", "-1", "15", "8193", "1k", "1024x512", "wide", "1e3", "''", "99999999999"}) {
    EXPECT_EQ(run(fmt::format("{} -o lit.glb --lightmap {}", kSolve, size)), 1) << size;
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_THAT(err, HasSubstr("--lightmap"));
    EXPECT_FALSE(std::filesystem::exists(path("lit.glb")));
  }
  EXPECT_EQ(run(std::string(kSolve) + "--lightmap 64"), 1) << "there is no lit scene to go with it";
  ASSERT_EQ(run(std::string(kSolve) + "--checkpoint c"), 0);
  EXPECT_EQ(run("sample c"), 1);
  EXPECT_THAT(text("err"), HasSubstr("--points"));
}

// The lit scene is there all the same.
TEST_F(LightmapCommand, TooManyChartsAreTold) {
  ASSERT_EQ(run("scene loose-triangles --count 500 -o loose.glb"), 0) << text("err");
  EXPECT_EQ(run("solve loose.glb --feature-size 50cm --error 50% --progress none -o lit.glb "
                "--lightmap 16"),
            1);
  const std::string err = text("err");
  EXPECT_THAT(err, HasSubstr("use at least --lightmap"));
  EXPECT_TRUE(std::filesystem::exists(path("lit.glb")));
}

}  // namespace
}  // namespace halflight
