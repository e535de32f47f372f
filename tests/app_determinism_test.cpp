// Every kind of output holds the same bytes for any number of threads, for every run, and after a
// solve that was interrupted and resumed.
#include <gtest/gtest.h>

#include <map>

#include "room_command.h"
#include "sanitized.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

struct DeterminismCase {
  const char* name;
  std::string make;   // the command that writes the scene as scene.glb; empty: room.obj
  std::string solve;  // options
  int interruptions = 3;
  const char* shared = "";  // instead of both: a scene of the shared corpus
};

// What of a report tells of time and of the machine.
constexpr std::array kOfThisRun{"phases",         "wall_seconds", "cpu_seconds",
                                "peak_rss_bytes", "memory",       "warnings"};
constexpr std::array kOfThisIteration{"seconds", "predicted_seconds", "refine_seconds",
                                      "sweep_seconds"};

void PrintTo(const DeterminismCase& c, std::ostream* out) { *out << c.name; }

std::string lasting_part(const fs::path& path, bool whole_run) {
  auto report = read_json(path);
  // Rays of the part before the interruption are not known.
  if (!whole_run) report.erase("rays");
  for (const char* key : kOfThisRun) report.erase(key);
  report["settings"].erase("threads");
  for (auto& iteration : report["history"])
    for (const char* key : kOfThisIteration) iteration.erase(key);
  return report.dump(1);
}

class CommandDeterminism : public RoomCommand,
                           public ::testing::WithParamInterface<DeterminismCase> {
 protected:
  void SetUp() override {
    RoomCommand::SetUp();
    if (!GetParam().make.empty()) {
      ASSERT_EQ(run(GetParam().make), 0) << text("err");
      scene_ = "scene.glb";
    }
    if (*GetParam().shared != 0) {
      scene_ = (shared_scenes() / GetParam().shared).string();
      if (!fs::exists(scene_)) GTEST_SKIP() << "the shared scenes are not here";
    }
    folder_.write("sensors.txt", sensors(0.12));
  }
  std::string solve(const std::string& folder, int threads) const {
    return fmt::format(
        "solve {1} --progress none --sky 0.1,0.2,0.3 {2} --threads {3} --points "
        "sensors.txt --points-out "
        "{0}/s.txt -o {0}/lit.glb --lightmap 64 --report {0}/r.json --light-groups --checkpoint "
        "{0}/c",
        folder, scene_, GetParam().solve, threads);
  }
  // Each kind of output there is, in a folder of its own.
  void write_all(const std::string& folder, int threads) const {
    fs::create_directory(path(folder));
    const std::string of_threads = fmt::format(" --threads {} ", threads);
    const std::string view =
        of_threads + "--camera 0.3,0.3,0.9,0.3,0.2,0,50 --size 40x30 --progress none -o ";
    const std::string points = of_threads + "--points sensors.txt --points-out ";
    const std::string at = folder + "/";
    expect_light(solve(folder, threads));
    expect_light("sample " + at + "c" + points + at + "s2.txt -o " + at + "lit2.glb");
    expect_light("mix " + at + "c" + of_threads + "--group sky=0.5 -o " + at + "mixed.glb");
    expect_light("render " + at + "c" + view + at + "p.exr");
    expect_light("render " + at + "c" + view + at + "p.png --mask-samples 8 --visibility-mask " +
                 at + "m.exr");
    expect_light("render " + scene_ + " --path-trace 4" + view + at + "t.exr");
    expect_light("reference " + scene_ + " --spp 16" + points + at + "ref.txt");
  }
  // A limit on memory may end a solve before its goal.
  void expect_light(const std::string& arguments) const {
    const int status = run(arguments);
    EXPECT_TRUE(status == 0 || status == 4) << arguments << ": " << text("err");
  }
  std::map<std::string, std::string> outputs(const std::string& folder,
                                             bool whole_run = true) const {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : fs::directory_iterator(path(folder))) {
      const std::string name = entry.path().filename().string();
      bytes[name] =
          name == "r.json" ? lasting_part(entry.path(), whole_run) : read_text(entry.path());
    }
    return bytes;
  }
  void expect_same(const std::map<std::string, std::string>& once, const std::string& folder,
                   bool whole_run = true) const {
    const auto again = outputs(folder, whole_run);
    EXPECT_EQ(again.size(), once.size());
    for (const auto& [name, bytes] : once) {
      EXPECT_GT(bytes.size(), 100u) << name;
      EXPECT_TRUE(again.count(name) == 1 && again.at(name) == bytes) << folder << ": " << name;
    }
  }

  std::string scene_ = "room.obj";
};

TEST_P(CommandDeterminism, EveryOutputIsTheSameForAnyThreadsAndRun) {
  write_all("one", 1);
  const auto once = outputs("one");
  EXPECT_EQ(once.size(), 14u);
  for (const int threads : {2, 4, 1}) {
    const std::string folder = fmt::format("again-{}", threads);
    write_all(folder, threads);
    expect_same(once, folder);
  }
}

TEST_P(CommandDeterminism, InterruptedAndResumedIsTheSame) {
  for (const char* folder : {"whole", "part"}) fs::create_directory(path(folder));
  const auto start = std::chrono::steady_clock::now();
  expect_light(solve("whole", 2));
  const auto took = std::chrono::steady_clock::now() - start;
  const auto whole = outputs("whole", false);
  // A solve that had ended, too.
  expect_light(solve("whole", 1) + " --resume");
  expect_same(whole, "whole", false);
  int interrupted = 0;
  const int times = GetParam().interruptions;
  for (int i = 0; i < times; ++i) {
    interrupted += run_and_signal(solve("part", 1), {SIGINT},
                                  std::chrono::duration_cast<std::chrono::milliseconds>(
                                      took * (2 * i + 1) / (2 * times))) == 3;
    expect_light(solve("part", 2) + " --resume");
    expect_same(whole, "part", false);
    for (const auto& file : whole) fs::remove(path("part") / file.first);
  }
  // Some signal comes in time, unless time itself is another.
  if (!test::kSanitized) {
    EXPECT_GT(interrupted, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, CommandDeterminism,
    ::testing::Values(
        DeterminismCase{"RoomSampled", "", "--feature-size 40cm --links sampled --error 20%", 16},
        DeterminismCase{"BoxSampled", "scene cornell-box -o scene.glb",
                        "--feature-size 8cm --links sampled --error 20%"},
        DeterminismCase{"CrowdRefined", "scene loose-triangles --count 300 -o scene.glb",
                        "--feature-size 20cm --links refined --error 20%"},
        DeterminismCase{"CrowdSampled", "scene loose-triangles --count 300 -o scene.glb",
                        "--feature-size 20cm --links sampled --error 20% --visibility multires"},
        DeterminismCase{"SharedBoxRefined", "", "--feature-size 30cm --links refined --error 20%",
                        3, "cornell-box/CornellBox-Original.obj"},
        DeterminismCase{"RoomInLittleMemory", "", "--feature-size 1cm --error 5% --memory 46MiB"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace halflight
