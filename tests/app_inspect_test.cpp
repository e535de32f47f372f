// The inspect command as users run it.
#include <array>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gltf_builder.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using testing::HasSubstr;

struct CommandRun {
  int status = -1;
  std::string out;
  std::string err;
};

CommandRun run(const TemporaryFolder& folder, const std::string& arguments) {
  const std::string err = (folder.path() / "stderr").string();
  const std::string command = std::string(HALFLIGHT_BINARY) + " " + arguments + " 2>" + err;
  CommandRun result;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> chunk;
  while (const std::size_t n = fread(chunk.data(), 1, chunk.size(), pipe))
    result.out.append(chunk.data(), n);
  result.status = WEXITSTATUS(pclose(pipe));
  std::ifstream in(err);
  result.err.assign(std::istreambuf_iterator<char>(in), {});
  return result;
}

std::string lamp(const TemporaryFolder& folder) {
  GltfBuilder gltf;
  gltf.add_triangle({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}});
  return folder.write("lamp.glb", gltf.glb()).string();
}

TEST(Inspect, JsonHoldsCountsEmittersAndFindings) {
  const TemporaryFolder folder;
  const CommandRun r = run(folder, "inspect " + lamp(folder) + " --json --sky 1,2,3");
  EXPECT_EQ(r.status, 0) << r.err;
  const nlohmann::json j = nlohmann::json::parse(r.out);
  EXPECT_EQ(j["triangles"], 1);
  EXPECT_EQ(j["emitters"][0]["material"], "lamp");
  EXPECT_NEAR(j["emitters"][0]["power"][0], 3.14159265, 1e-5);  // both sides of half a m2
  EXPECT_EQ(j["sky"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_TRUE(j["findings"].is_array());
}

TEST(Inspect, TellsOfHierarchiesOnRequest) {
  const TemporaryFolder folder;
  const CommandRun all = run(folder, "inspect " + lamp(folder) + " --json --hierarchy all");
  EXPECT_EQ(all.status, 0) << all.err;
  const nlohmann::json j = nlohmann::json::parse(all.out)["hierarchies"];
  ASSERT_EQ(j.size(), 4u);
  EXPECT_EQ(j[3]["name"], "agglomerative");
  EXPECT_EQ(j[3]["clusters"], 1);
  EXPECT_THAT(run(folder, "inspect " + lamp(folder) + " --hierarchy kd-tree").out,
              HasSubstr("hierarchy  kd-tree: 1 clusters"));
  EXPECT_FALSE(nlohmann::json::parse(run(folder, "inspect --json " + lamp(folder)).out)
                   .contains("hierarchies"));
  EXPECT_NE(run(folder, "inspect " + lamp(folder) + " --hierarchy octree").status, 0);
}

TEST(Inspect, UnitsScaleTheSceneAndAreCheckedByName) {
  const TemporaryFolder folder;
  const auto size = [&](const std::string& options) {
    const CommandRun r = run(folder, "inspect --json " + lamp(folder) + options);
    return nlohmann::json::parse(r.out)["diagonal"].get<double>();
  };
  EXPECT_NEAR(size(" --unit ft"), 0.3048 * size(""), 1e-6);
  const CommandRun wrong = run(folder, "inspect --unit furlong " + lamp(folder));
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("'furlong' is none of m, cm, mm, in, ft"));
  EXPECT_EQ(run(folder, "inspect --sky 1,-1,1 " + lamp(folder)).status, 1);
}

TEST(Inspect, BadInputIsOneLineOnStderrAndStatusOne) {
  const TemporaryFolder folder;
  const CommandRun r = run(folder, "inspect " + folder.write("broken.glb", "not a scene").string());
  EXPECT_EQ(r.status, 1);
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("broken.glb"));
  EXPECT_EQ(std::ranges::count(r.err, '\n'), 1);
}

}  // namespace
}  // namespace halflight
