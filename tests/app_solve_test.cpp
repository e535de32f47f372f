// The solve command from outside: exit status, files, units, threads, interruption.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "gltf_check.h"
#include "room_command.h"
#include "sanitized.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

class SolveCommand : public RoomCommand {};

long lines_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST_F(SolveCommand, WritesTheSameBytesWhateverTheThreads) {
  for (const char* links : {"refined", "sampled"}) {
    const std::string common =
        std::string("solve room.obj --feature-size 50cm --progress none --links ") + links +
        " --points sensors.txt";
    ASSERT_EQ(run(common + " -o one.glb --points-out one.txt --threads 1"), 0) << text("err");
    ASSERT_EQ(run(common + " -o two.glb --points-out two.txt --threads 2"), 0) << text("err");
    EXPECT_EQ(irradiance_of(text("one.txt")).size(), 30u);
    EXPECT_EQ(text("one.txt"), text("two.txt"));
    EXPECT_GT(text("one.glb").size(), 1000u);
    EXPECT_EQ(text("one.glb"), text("two.glb"));
  }
}

TEST_F(SolveCommand, LitSceneIsValidGltf) {
  if (!test::have_gltf_validator()) GTEST_SKIP() << "the glTF validator is not installed";
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --progress none -o lit.glb"), 0);
  EXPECT_TRUE(test::is_valid_gltf(path("lit.glb")));
}

TEST_F(SolveCommand, LightDoesNotDependOnTheUnit) {
  const std::string common = " --feature-size 25cm --progress none";
  ASSERT_EQ(run("solve room.obj --points sensors.txt --points-out m.txt" + common), 0);
  folder_.write("room_cm.obj", room_obj(100.0));
  folder_.write("sensors_cm.txt", sensors(100.0));
  ASSERT_EQ(run("solve room_cm.obj --unit cm --points sensors_cm.txt --points-out cm.txt" + common),
            0);
  const auto metres = irradiance_of(text("m.txt")), centimetres = irradiance_of(text("cm.txt"));
  ASSERT_EQ(metres.size(), 30u);
  ASSERT_EQ(centimetres.size(), 30u);
  for (std::size_t i = 0; i < metres.size(); ++i) {
    EXPECT_GT(metres[i], 0.f);
    EXPECT_NEAR(centimetres[i] / metres[i], 1.f, 0.01f) << "sensor " << i / 3;
  }
}

TEST_F(SolveCommand, SensorsGoToStandardOutputWithoutAFile) {
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --points sensors.txt"), 0);
  EXPECT_EQ(irradiance_of(text("out")).size(), 30u);
}

TEST_F(SolveCommand, SensorsWithoutAGatherReadNearlyTheSame) {
  folder_.write("with_air.txt", sensors(1.0) + "2 2 1 0 1 0\n");
  const std::string common =
      "solve room.obj --feature-size 25cm --progress none --points with_air.txt";
  ASSERT_EQ(run(common + " --points-out gathered.txt"), 0) << text("err");
  ASSERT_EQ(run(common + " --points-out cells.txt --final-gather 0"), 0) << text("err");
  const auto gathered = irradiance_of(text("gathered.txt")),
             cells = irradiance_of(text("cells.txt"));
  ASSERT_EQ(gathered.size(), 33u);
  ASSERT_EQ(cells.size(), 33u);
  EXPECT_NE(gathered, cells);
  for (std::size_t i = 0; i < cells.size(); ++i)
    EXPECT_NEAR(cells[i] / gathered[i], 1.f, 0.1f) << "sensor " << i / 3;
}

TEST_F(SolveCommand, ReportBalancesItsEnergy) {
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --progress none --report report.json"), 0);
  const auto report = read_json(path("report.json"));
  for (const char* key :
       {"input", "settings", "phases", "wall_seconds", "cpu_seconds", "peak_rss_bytes", "rays",
        "clusters", "elements", "links", "sweeps", "energy", "history", "warnings"})
    EXPECT_TRUE(report.contains(key)) << key;
  // 10 W/(m2 sr) in the red over 1 m2; nothing leaves the closed room.
  EXPECT_NEAR(report["energy"]["emitted"][0].get<double>(), 31.4159, 0.01);
  EXPECT_NEAR(report["energy"]["escaped"][0].get<double>(), 0.0, 0.32);
}

TEST_F(SolveCommand, ErrorIsMeasuredAndMet) {
  ASSERT_EQ(run("solve room.obj --feature-size 20cm --error 8% --progress none --report r.json"),
            0);
  const auto report = read_json(path("r.json"));
  EXPECT_LE(report["estimated_error"].get<double>(), 0.08);
  EXPECT_GT(report["estimated_error_noise"].get<double>(), 0.0);
}

TEST_F(SolveCommand, OptionsMayStandBeforeTheScene) {
  EXPECT_EQ(run("solve --links refined --links 1M --importance auto --feature-size 50cm "
                "--progress none --report r.json room.obj"),
            0)
      << text("err");
  EXPECT_EQ(read_json(path("r.json"))["settings"]["links"], "refined");
}

TEST_F(SolveCommand, RulesGiveMaterialsTheirFeatureSize) {
  folder_.write("rules.toml", "[[rule]]\nmaterial = \"wall\"\nfeature-size = \"10cm\"\n");
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --progress none --report a.json"), 0);
  ASSERT_EQ(run("solve room.obj --feature-size 50cm --feature-sizes rules.toml --progress none "
                "--report b.json"),
            0);
  EXPECT_GT(read_json(path("b.json"))["elements"].get<int>(),
            read_json(path("a.json"))["elements"].get<int>());
  folder_.write("rules.toml", "[[rule]]\nmaterial = \"glass\"\nfeature-size = \"10cm\"\n");
  EXPECT_EQ(run("solve room.obj --feature-sizes rules.toml --progress none --report c.json"), 1);
  EXPECT_NE(text("err").find("glass"), std::string::npos);
}

TEST_F(SolveCommand, NamesThatAreNotUtf8LeaveTheReportWhole) {
  folder_.write("kitchen.mtl",
                "newmtl K\xfc"
                "che\nKd 0.5 0.5 0.5\nmap_Kd none\xfc.png\n");
  folder_.write("kitchen.obj",
                "mtllib kitchen.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl K\xfc"
                "chen\nf 1 2 3\n"
                "usemtl K\xfc"
                "che\nf 3 2 1\n");
  ASSERT_EQ(run("solve kitchen.obj --sky 1,1,1 --report report.json -o lit.glb"), 0) << text("err");
  const auto report = nlohmann::json::parse(text("report.json"));
  EXPECT_FALSE(report["warnings"].empty());
}

TEST_F(SolveCommand, UnreachableErrorEndsWithABudgetStatus) {
  EXPECT_EQ(run("solve room.obj --feature-size 1 --error 0.01% --links 30k --progress none "
                "--report r.json --points sensors.txt --points-out out.txt"),
            4);
  EXPECT_LE(read_json(path("r.json"))["links"].get<double>(), 40e3);
  EXPECT_EQ(irradiance_of(text("out.txt")).size(), 30u);
}

TEST_F(SolveCommand, RejectsBadUseInOneLine) {
  for (const char* arguments : {"solve missing.obj",
                                "solve room.obj --feature-size huge",
                                "solve room.obj --feature-size -1",
                                "solve room.obj --visibility blurred",
                                "solve room.obj --error 0%",
                                "solve room.obj --error 0.00001%",
                                "solve room.obj --error 1e9%",
                                "solve room.obj --sky 1e20,0,0",
                                "solve room.obj --error x",
                                "solve room.obj --time soon",
                                "solve room.obj --links woven",
                                "solve room.obj --threads -1",
                                "solve room.obj --unit mile",
                                "solve room.obj --up x",
                                "solve room.obj --points missing.txt",
                                "solve room.obj --points sensors.txt --final-gather -3",
                                "solve room.obj --points sensors.txt --final-gather some",
                                "solve room.obj --sky 1,2",
                                "solve",
                                "solve room.obj --sky -1,0,0",
                                "solve room.obj --no-such-option",
                                "solve room.obj --feature-size nan",
                                "solve room.obj --feature-size 3px@",
                                "solve room.obj --feature-size xpx@auto",
                                "solve room.obj --importance nowhere",
                                "solve room.obj --feature-sizes none.toml",
                                "solve room.obj --feature-size inf",
                                "solve room.obj --feature-size 1e39",
                                "solve room.obj --feature-size 1e30",
                                "solve room.obj --feature-size 1e-50",
                                "solve room.obj --report ''",
                                "solve room.obj --checkpoint ''",
                                "solve room.obj --points ''"}) {
    EXPECT_EQ(run(std::string(arguments) + " --progress none -o lit.glb"), 1) << arguments;
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << arguments << "\n" << err;
    EXPECT_FALSE(fs::exists(path("lit.glb"))) << arguments;
  }
}

TEST_F(SolveCommand, OtherCommandsRejectNumbersThatTheyCannotHold) {
  const std::string reference = "reference room.obj --points sensors.txt --points-out o.txt ";
  const std::string render = "render room.obj --feature-size 1 --size 8x8 -o o.png ";
  for (const std::string& arguments :
       {reference + "--spp 2 --seed -1", reference + "--spp 2 --seed 99999999999999999999",
        reference + "--spp 2 --seed nan", reference + "--spp -4294967294",
        reference + "--spp 2 --threads 2147483647", reference + "--spp 2 --threads -1",
        render + "--seed -1", render + "--seed 99999999999999999999", render + "--path-trace -1",
        render + "--samples 99999999999999999999"}) {
    EXPECT_EQ(run(arguments), 1) << arguments;
    EXPECT_EQ(lines_of(text("err")), 1) << arguments << "\n" << text("err");
    EXPECT_FALSE(fs::exists(path("o.txt")) || fs::exists(path("o.png"))) << arguments;
  }
  EXPECT_EQ(run(reference + "--spp 2 --seed 18446744073709551615"), 0) << text("err");
}

TEST_F(SolveCommand, RejectsAnOutputWithoutAName) {
  EXPECT_EQ(run("solve room.obj --feature-size 1 --progress none -o ''"), 1);
  EXPECT_EQ(lines_of(text("err")), 1) << text("err");
}

TEST_F(SolveCommand, LargestFeatureSizeGivesACheckpointThatCanBeRead) {
  EXPECT_EQ(
      run("solve room.obj --feature-size 1e15 --progress none --checkpoint c --report r.json"), 0)
      << text("err");
  EXPECT_TRUE(read_json(path("r.json"))["settings"]["feature_size"].is_number());
  EXPECT_EQ(run("sample c --points sensors.txt"), 0) << text("err");
}

TEST_F(SolveCommand, PathTracersRejectWhatSolvingRejects) {
  const std::string render = "render room.obj --size 8x8 --path-trace 1 -o o.png ";
  const std::string reference =
      "reference room.obj --points sensors.txt --spp 2 --points-out o.txt ";
  for (const std::string& arguments :
       {render + "--error banana", render + "--links banana", render + "--memory banana",
        render + "--time banana", render + "--feature-size banana",
        render + "--visibility multires --feature-size 12px@auto",
        reference + "--visibility multires --feature-size 12px@nosuchcamera",
        reference + "--feature-size banana", reference + "--feature-size 1e39"}) {
    EXPECT_EQ(run(arguments), 1) << arguments;
    EXPECT_EQ(lines_of(text("err")), 1) << arguments << "\n" << text("err");
    EXPECT_FALSE(fs::exists(path("o.txt")) || fs::exists(path("o.png"))) << arguments;
  }
}

TEST_F(SolveCommand, WarnsInOneLineOfOptionsWithoutEffect) {
  ASSERT_EQ(run("solve room.obj --feature-size 1 --progress none --light-groups --checkpoint c"),
            0);
  const std::string solve = "solve room.obj --feature-size 1 --progress none --report r.json ";
  const std::string view = " --size 8x8 --progress none --camera 1,2,4.5,3,1,0,70 ";
  const std::string traced = "render room.obj --path-trace 1" + view;
  const std::string reference = "reference room.obj --points sensors.txt --spp 2 ";
  const std::pair<std::string, std::string> cases[] = {
      {solve + "--final-gather 8", "--final-gather"},
      {"sample c -o lit.glb --final-gather 8", "--final-gather"},
      {"mix c", "nothing will be written"},
      {traced + "-o o.png --error 5% --samples 3 --importance nosuch",
       "--error, --importance, --samples"},
      {traced + "-o o.png --feature-size 12px@nosuch", "--feature-size"},
      {traced + "-o o.exr --exposure 2 --tone-map none", "--exposure, --tone-map"},
      {"render c" + view + "-o o.png --bounces clusters", "--bounces"},
      {reference + "--feature-size 50cm --bounces clusters", "--feature-size, --bounces"}};
  for (const auto& [arguments, named] : cases) {
    EXPECT_EQ(run(arguments), 0) << arguments;
    const std::string err = text("err");
    EXPECT_EQ(lines_of(err), 1) << arguments << "\n" << err;
    EXPECT_EQ(err.rfind("halflight: warning: ", 0), 0u) << arguments << "\n" << err;
    EXPECT_NE(err.find(named + " "), std::string::npos) << arguments << "\n" << err;
  }
  for (const std::string& silent :
       {traced + "-o o.png --visibility exact --feature-size 50cm",
        reference + "--visibility exact --feature-size 50cm", traced + "-o o.png --exposure 2"}) {
    EXPECT_EQ(run(silent), 0) << silent;
    EXPECT_EQ(text("err"), "") << silent;
  }
  EXPECT_EQ(run(traced + "-o o.png --mask-samples 8"), 1);
  EXPECT_EQ(lines_of(text("err")), 1) << text("err");
}

TEST_F(SolveCommand, CamerasDoNotAskForPicturesThatFillTheMemory) {
  folder_.write("huge.json", R"({"position": [1, 2, 4], "target": [3, 1, 0], "width": 32768,
                                 "height": 32768})");
  EXPECT_EQ(run("render room.obj --path-trace 1 --camera huge.json -o o.png"), 1);
  EXPECT_EQ(lines_of(text("err")), 1) << text("err");
  EXPECT_NE(text("err").find("--size 32768x32768"), std::string::npos) << text("err");
  EXPECT_EQ(run("render room.obj --path-trace 1 --camera huge.json --size 8x8 --progress none "
                "-o o.png"),
            0)
      << text("err");
}

TEST_F(SolveCommand, UnwritablePlaceIsASystemFailure) {
  EXPECT_EQ(run("solve room.obj --feature-size 1 --progress none -o no/such/folder/lit.glb"), 2);
}

// An office at a fine feature size takes far longer than a second.
class LongSolve : public SolveCommand {
 protected:
  void SetUp() override {
    SolveCommand::SetUp();
    ASSERT_EQ(run("scene office --count 100 -o office.glb"), 0);
    folder_.write("desk.txt", "0.5 0 0.5 0 1 0\n-0.5 0 0.5 0 1 0\n");
  }
  void expect_valid_light() const {
    const auto values = irradiance_of(text("desk_out.txt"));
    ASSERT_EQ(values.size(), 6u);
    for (const float e : values) EXPECT_TRUE(std::isfinite(e) && e >= 0.f) << e;
  }
  static constexpr const char* kLong =
      "solve office.glb --feature-size 3mm --error 0.2% --progress none --points desk.txt "
      "--points-out desk_out.txt --report report.json";
};

TEST_F(LongSolve, InterruptedWritesAValidResult) {
  EXPECT_EQ(run_and_signal(kLong, {SIGINT}, std::chrono::milliseconds(1500)), 3);
  expect_valid_light();
}

// The second one is of the other kind, as after Ctrl-C a stop from elsewhere.
TEST_F(LongSolve, InterruptedTwiceEndsAtOnce) {
  if (test::kThreadSanitized) GTEST_SKIP() << "the thread sanitizer holds signals back";
  EXPECT_EQ(run_and_signal(kLong, {SIGINT, SIGTERM}, std::chrono::milliseconds(1500)), -1);
  EXPECT_EQ(run_and_signal(kLong, {SIGTERM, SIGINT}, std::chrono::milliseconds(1500)), -1);
  EXPECT_FALSE(fs::exists(path("report.json")));
}

TEST_F(LongSolve, SignalsThatAreIgnoredStaySo) {
  const std::string command = "(trap '' INT; cd '" + folder_.path().string() +
                              "'; '" HALFLIGHT_BINARY "' " + kLong +
                              " --time 2s & sleep 1; kill -INT $!; wait $!)";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 4) << "the deadline has ended it";
}

TEST_F(LongSolve, DeadlineWritesAValidResult) {
  EXPECT_EQ(run(std::string(kLong) + " --time 1s"), 4);
  expect_valid_light();
  EXPECT_LT(read_json(path("report.json"))["wall_seconds"].get<double>(), 2.0);
}

TEST_F(SolveCommand, GenerousDeadlineMeetsTheGoal) {
  EXPECT_EQ(run("solve room.obj --feature-size 50cm --progress none --time 10m -o lit.glb"), 0);
  EXPECT_TRUE(fs::exists(path("lit.glb")));
}

}  // namespace
}  // namespace halflight
