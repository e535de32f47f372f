// Checkpoints from outside: killed and resumed solves, and commands that read what was stored.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "halflight/base/hash.h"
#include "room_command.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class CheckpointCommand : public RoomCommand {
 protected:
  // Half a second, in iterations that all take their time.
  void SetUp() override {
    RoomCommand::SetUp();
    ASSERT_EQ(run("scene cornell-box -o box.glb"), 0);
    folder_.write("points.txt", "0.2 0 0.3 0 1 0\n0.4 0.1 0.2 0 1 0\n");
  }
  static std::string solve(const std::string& name) {
    return "solve box.glb --feature-size 4cm --progress none --points points.txt --points-out " +
           name + ".txt --checkpoint " + name + ".ckpt";
  }
  std::string one_line_error(const std::string& arguments, int status = 1) const {
    EXPECT_EQ(run(arguments), status) << arguments;
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    return err;
  }
};

TEST_F(CheckpointCommand, KilledAndResumedGivesTheSameBytes) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run(solve("whole")), 0) << text("err");
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::steady_clock::now() - start);
  // On a busy machine the first run may have taken longer than the others will.
  int killed = 0;
  for (std::uint64_t i = 0; killed < 8 && i < 48; ++i) {
    fs::remove(path("part.ckpt"));
    // Each is killed once or twice, at moments spread over the run.
    for (std::uint64_t k = 0; k < 1 + i % 2; ++k) {
      const auto delay = std::chrono::milliseconds(
          static_cast<int>(static_cast<float>(took.count()) * to_unit_float(hash(i, k))));
      if (run_and_signal(solve("part") + " --resume", {SIGKILL}, delay) == -1) ++killed;
    }
    ASSERT_EQ(run(solve("part") + " --resume"), 0) << text("err");
    EXPECT_EQ(text("part.txt"), text("whole.txt"));
    EXPECT_TRUE(text("part.ckpt") == text("whole.ckpt"));
  }
  EXPECT_GE(killed, 8);
}

TEST_F(CheckpointCommand, InterruptedAndResumedGivesTheSameBytes) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run(solve("whole")), 0) << text("err");
  auto delay = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::steady_clock::now() - start);
  // Later runs may be faster than the first.
  int status = 0;
  for (int attempt = 0; attempt < 8 && status != 3; ++attempt) {
    delay = delay * 3 / 4;
    status = run_and_signal(solve("part"), {SIGINT}, delay);
  }
  ASSERT_EQ(status, 3);
  ASSERT_EQ(run(solve("part") + " --resume"), 0) << text("err");
  EXPECT_EQ(text("part.txt"), text("whole.txt"));
  EXPECT_TRUE(text("part.ckpt") == text("whole.ckpt"));
}

TEST_F(CheckpointCommand, ASolutionStaysUntilThereIsAnother) {
  ASSERT_EQ(run(solve("part")), 0) << text("err");
  // Killed before its first light, or a while after.
  for (const int milliseconds : {20, 60, 120}) {
    run_and_signal("solve box.glb --feature-size 5mm --progress none --checkpoint part.ckpt",
                   {SIGKILL}, std::chrono::milliseconds(milliseconds));
    EXPECT_EQ(run("sample part.ckpt --points points.txt"), 0) << text("err");
  }
}

TEST_F(CheckpointCommand, LitSceneOfAResumedSolveIsTheSame) {
  const std::string common = "solve room.obj --feature-size 25cm --progress none --checkpoint c";
  ASSERT_EQ(run(common + " -o whole.glb"), 0);
  ASSERT_EQ(run(common + " --resume -o resumed.glb"), 0);
  EXPECT_GT(text("whole.glb").size(), 1000u);
  EXPECT_TRUE(text("whole.glb") == text("resumed.glb"));
}

TEST_F(CheckpointCommand, SampleReadsWhatSolveReads) {
  const std::string solve_room =
      "solve room.obj --feature-size 25cm --sky 0.1,0.2,0.3 --progress none";
  ASSERT_EQ(run(solve_room + " --checkpoint c --points sensors.txt --points-out solved.txt"), 0);
  ASSERT_EQ(run("sample c --points sensors.txt --points-out sampled.txt"), 0) << text("err");
  EXPECT_EQ(irradiance_of(text("solved.txt")).size(), 30u);
  EXPECT_EQ(text("solved.txt"), text("sampled.txt"));
  ASSERT_EQ(run("sample c --points sensors.txt --threads 1"), 0);
  EXPECT_EQ(text("solved.txt"), text("out"));
}

TEST_F(CheckpointCommand, RenderShowsWhatSolveFound) {
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --progress none --checkpoint c"), 0);
  const std::string view = " --camera 1,2,4.5,3,1,0,70 --size 48x32 --progress none -o ";
  ASSERT_EQ(run("render room.obj --feature-size 50cm" + view + "solved.exr"), 0);
  ASSERT_EQ(run("render c" + view + "stored.exr"), 0) << text("err");
  EXPECT_GT(text("solved.exr").size(), 500u);
  EXPECT_TRUE(text("solved.exr") == text("stored.exr"));
  EXPECT_THAT(one_line_error("render c --error 1%" + view + "x.exr"), HasSubstr("--error"));
  EXPECT_THAT(one_line_error("render c --sky 1,1,1" + view + "x.exr"), HasSubstr("--sky"));
  EXPECT_THAT(one_line_error("render room.obj --scene room.obj" + view + "x.exr"),
              HasSubstr("--scene"));
}

TEST_F(CheckpointCommand, MovesTogetherWithItsScene) {
  fs::create_directory(path("here"));
  fs::create_directory(path("here/results"));
  for (const char* name : {"room.obj", "room.mtl"}) fs::copy(path(name), path("here") / name);
  ASSERT_EQ(run("solve here/room.obj --feature-size 50cm --progress none --checkpoint "
                "here/results/c --points sensors.txt --points-out solved.txt"),
            0);
  fs::rename(path("here"), path("there"));
  ASSERT_EQ(run("sample there/results/c --points sensors.txt"), 0) << text("err");
  EXPECT_EQ(text("out"), text("solved.txt"));
  fs::rename(path("there/results/c"), path("alone"));
  EXPECT_THAT(one_line_error("sample alone --points sensors.txt"), HasSubstr("--scene"));
  ASSERT_EQ(run("sample alone --scene there/room.obj --points sensors.txt"), 0) << text("err");
  EXPECT_EQ(text("out"), text("solved.txt"));
}

TEST_F(CheckpointCommand, MixDimsAndRecolours) {
  const std::string common =
      "solve room.obj --feature-size 50cm --sky 0.2,0.2,0.2 --progress none ";
  ASSERT_EQ(run(common + "--checkpoint c --light-groups --points sensors.txt --points-out s.txt"),
            0)
      << text("err");
  ASSERT_EQ(run("sample c --points sensors.txt"), 0) << text("err");
  EXPECT_EQ(text("out"), text("s.txt"));
  ASSERT_EQ(run("mix c --points sensors.txt"), 0) << text("err");
  EXPECT_EQ(text("out"), text("s.txt"));
  ASSERT_EQ(run("mix c --group lamp=0.5 --group sky=0 --points sensors.txt -o lit.glb"), 0)
      << text("err");
  const auto whole = irradiance_of(text("s.txt")), half = irradiance_of(text("out"));
  ASSERT_EQ(whole.size(), half.size());
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(half[i] / whole[i], 0.5f, 0.005f);
  EXPECT_GT(text("lit.glb").size(), 1000u);
  ASSERT_EQ(run("mix c --group lamp=1,0,0 --points sensors.txt"), 0);
  const auto red = irradiance_of(text("out"));
  for (std::size_t i = 0; i < red.size(); i += 3) {
    EXPECT_GT(red[i], 0.f);
    EXPECT_EQ(red[i + 1], 0.f);
  }
  EXPECT_THAT(one_line_error("mix c --group bulb=1"), HasSubstr("the checkpoint has lamp, sky"));
  for (const char* factor :
       {"lamp", "lamp=", "lamp=-1", "lamp=1,2", "lamp=nan", "lamp=1e9", "lamp=1,2,3,4"})
    EXPECT_THAT(one_line_error(std::string("mix c --group ") + factor), HasSubstr("--group"));
  EXPECT_THAT(one_line_error(common + "--checkpoint c --resume"), HasSubstr("light groups"));
  ASSERT_EQ(run(common + "--checkpoint c --light-groups --resume"), 0) << text("err");
  ASSERT_EQ(run("solve room.obj --feature-size 1 --progress none --checkpoint d"), 0);
  EXPECT_THAT(one_line_error("mix d --group lamp=1"), HasSubstr("no light groups"));
}

TEST_F(CheckpointCommand, MoreLightGroupsThanCanBeKeptApartAreRefused) {
  std::string materials, faces = "mtllib lamps.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 257; ++i) {
    materials += fmt::format("newmtl lamp{}\nKe 1\n", i);
    faces += fmt::format("usemtl lamp{}\nf 1 2 3\n", i);
  }
  folder_.write("lamps.mtl", materials);
  folder_.write("lamps.obj", faces);
  EXPECT_THAT(one_line_error("solve lamps.obj --progress none --checkpoint c --light-groups"),
              HasSubstr("257 groups of lights, and at most 256"));
  EXPECT_FALSE(fs::exists(path("c")));
}

TEST_F(CheckpointCommand, SaysWhyItCannotGoOn) {
  const std::string common = "solve room.obj --progress none --points sensors.txt --checkpoint c";
  ASSERT_EQ(run(common + " --feature-size 50cm"), 0);
  EXPECT_THAT(one_line_error(common + " --feature-size 25cm --resume"),
              HasSubstr("feature-size is 0.5 there and 0.25 here"));
  EXPECT_THAT(one_line_error(common + " --feature-size 50cm --sky 1,1,1 --resume"),
              HasSubstr("its sky is 0,0,0, not 1,1,1"));
  EXPECT_THAT(one_line_error(common + " --feature-size 50cm --unit cm --resume"),
              HasSubstr("its unit is 1 m, not 0.01 m"));
  folder_.write("room.mtl", std::string(kRoomMaterials) + "Kd 0.1 0.1 0.1\n");
  EXPECT_THAT(one_line_error(common + " --feature-size 50cm --resume"), HasSubstr("another scene"));
  EXPECT_THAT(one_line_error("sample c --points sensors.txt"),
              HasSubstr("not the scene that was solved"));
  folder_.write("room.mtl", kRoomMaterials);
  ASSERT_EQ(run(common + " --feature-size 50cm --resume"), 0) << text("err");

  const std::string whole = text("c");
  folder_.write("c", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(one_line_error(common + " --feature-size 50cm --resume"), HasSubstr("cut short"));
  folder_.write("c", "something else");
  EXPECT_THAT(one_line_error("sample c --points sensors.txt"), HasSubstr("not a checkpoint"));
  EXPECT_THAT(one_line_error("sample missing --points sensors.txt"), HasSubstr("missing"));
}

TEST_F(CheckpointCommand, BeginsAnewWhereThereIsNone) {
  const std::string common = "solve room.obj --feature-size 50cm --progress none --checkpoint c";
  ASSERT_EQ(run(common + " --resume"), 0);
  EXPECT_THAT(text("err"), HasSubstr("from the beginning"));
  EXPECT_TRUE(fs::exists(path("c")));
  EXPECT_EQ(run("solve room.obj --resume --progress none"), 1);
}

TEST_F(CheckpointCommand, UnwritablePlaceIsASystemFailure) {
  EXPECT_THAT(one_line_error("solve room.obj --progress none --checkpoint no/such/folder/c", 2),
              HasSubstr("no/such/folder/c"));
}

}  // namespace
}  // namespace halflight
