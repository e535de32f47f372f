// Disks that are full, places that may not be written to, input that goes away, memory and threads
// that run out: one clear line, and what was there before is still there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "gltf_check.h"
#include "halflight/base/hash.h"
#include "halflight/io/atomic_file.h"
#include "limited_run.h"
#include "room_command.h"
#include "sanitized.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;
using test::kCannotPrepare;
using test::kSanitized;
using test::Preparation;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr int kSystemFailure = 2;

// A command that writes `file` as its only output. OUTPUT stands for its name.
struct OutputKind {
  const char* name;
  const char* file;
  std::string command;
};

const std::string kSolve = "solve room.obj --feature-size 50cm --progress none ";
const std::string kView = " --camera 1,2,4.5,3,1,0,70 --size 48x32 --progress none ";

const std::vector<OutputKind>& output_kinds() {
  static const std::vector<OutputKind> kinds{
      {"LitScene", "lit.glb", kSolve + "-o OUTPUT"},
      {"Sensors", "s.txt", kSolve + "--points sensors.txt --points-out OUTPUT"},
      {"Report", "r.json", kSolve + "--report OUTPUT"},
      {"Checkpoint", "c", kSolve + "--checkpoint OUTPUT"},
      {"Picture", "p.png", "render room.obj --feature-size 50cm" + kView + "-o OUTPUT"},
      {"PictureInExr", "p.exr", "render room.obj --path-trace 1" + kView + "-o OUTPUT"},
      {"Sampled", "s.txt", "sample kept --points sensors.txt --points-out OUTPUT"},
      {"SampledScene", "lit.glb", "sample kept -o OUTPUT"},
      {"Mixed", "lit.glb", "mix kept -o OUTPUT"},
      {"Reference", "s.txt", "reference room.obj --points sensors.txt --spp 4 --points-out OUTPUT"},
      {"Scene", "box.glb", "scene cornell-box -o OUTPUT"},
      {"Difference", "d.exr", "compare kept.png kept.png --difference OUTPUT"},
  };
  return kinds;
}

class Faults : public RoomCommand {
 protected:
  void SetUp() override {
    RoomCommand::SetUp();
    std::string many;
    for (int i = 0; i < 10; ++i) many += sensors(1.0);
    folder_.write("sensors.txt", many);
  }
  // What some kinds of output are made from.
  void keep() const {
    ASSERT_EQ(run(kSolve + "--light-groups --checkpoint kept"), 0) << text("err");
    ASSERT_EQ(run("render kept" + kView + "-o kept.png"), 0) << text("err");
  }
  int run_under(const Preparation& prepare, const std::string& arguments) const {
    for (const char* name : {"out", "err"}) std::ofstream(path(name), std::ios::trunc);
    return test::run_limited(folder_.path(), HALFLIGHT_BINARY, arguments, prepare);
  }
  void expect_one_line() const {
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_EQ(err.rfind("halflight: ", 0), 0u) << err;
  }
  void expect_nothing_unfinished() const {
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
  }
};

std::string with_output(const OutputKind& kind, const std::string& name) {
  std::string command = kind.command;
  return command.replace(command.find("OUTPUT"), 6, name);
}

class OutputFaults : public Faults, public ::testing::WithParamInterface<OutputKind> {
 protected:
  void SetUp() override {
    Faults::SetUp();
    if (GetParam().command.find("kept") != std::string::npos) keep();
  }
};

TEST_P(OutputFaults, FullDiskLeavesWhatWasThere) {
  const OutputKind& kind = GetParam();
  const std::string command = with_output(kind, kind.file);
  folder_.write(kind.file, "what was there");
  // Enough for the line on stderr, and for a part of any output.
  const auto limit = [] { return test::set_limit(RLIMIT_FSIZE, 256); };
  EXPECT_EQ(run_under(limit, command), kSystemFailure) << text("err");
  EXPECT_THAT(text("err"), HasSubstr(std::string(kind.file) + ": cannot write: File too large"));
  expect_one_line();
  EXPECT_EQ(text(kind.file), "what was there");
  expect_nothing_unfinished();
  ASSERT_EQ(run(command), 0) << text("err");
  EXPECT_GT(text(kind.file).size(), 256u);
}

TEST_P(OutputFaults, FullDeviceIsASystemFailure) {
  fs::create_symlink("/dev/full", path(GetParam().file));
  EXPECT_EQ(run(with_output(GetParam(), GetParam().file)), kSystemFailure);
  EXPECT_THAT(text("err"), HasSubstr("No space left"));
}

TEST_P(OutputFaults, FolderInPlaceOfAFileIsToldAtOnce) {
  const OutputKind& kind = GetParam();
  fs::create_directory(path(kind.file));
  EXPECT_EQ(run(with_output(kind, kind.file)), kSystemFailure);
  EXPECT_THAT(text("err"), HasSubstr(std::string(kind.file) + ": cannot write: Is a directory"));
  expect_one_line();
  EXPECT_TRUE(fs::is_empty(path(kind.file)));
  expect_nothing_unfinished();
}

TEST_P(OutputFaults, ReadOnlyFolderIsToldAtOnce) {
  const OutputKind& kind = GetParam();
  fs::create_directory(path("locked"));
  folder_.write("locked/" + std::string(kind.file), "what was there");
  fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
  const int status =
      run_under(test::obey_rights, with_output(kind, fmt::format("locked/{}", kind.file)));
  fs::permissions(path("locked"), fs::perms::owner_all);
  if (status == kCannotPrepare) GTEST_SKIP() << "root may write anywhere here";
  EXPECT_EQ(status, kSystemFailure);
  EXPECT_THAT(text("err"), HasSubstr("cannot write: Permission denied"));
  expect_one_line();
  EXPECT_EQ(text("locked/" + std::string(kind.file)), "what was there");
}

INSTANTIATE_TEST_SUITE_P(Kinds, OutputFaults, ::testing::ValuesIn(output_kinds()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(Faults, StandardOutputThatIsFullIsASystemFailure) {
  keep();
  for (const char* arguments :
       {"--help", "--version", "scene list", "inspect room.obj", "inspect room.obj --json",
        "sample kept --points sensors.txt", "compare kept.png kept.png --json"}) {
    const std::string line = "cd '" + folder_.path().string() + "' && '" HALFLIGHT_BINARY "' " +
                             arguments + " >/dev/full 2>err";
    const int status = std::system(line.c_str());
    EXPECT_EQ(WEXITSTATUS(status), kSystemFailure) << arguments;
    EXPECT_THAT(text("err"), HasSubstr("standard output")) << arguments;
  }
}

TEST_F(Faults, OneOutputThatFailsKeepsNoOtherFromBeingWritten) {
  for (const char* full : {"full.glb", "full.txt", "full.json", "full.ckpt"}) {
    fs::create_symlink("/dev/full", path(full));
    const auto name = [&](const char* whole) {
      return fs::path(whole).extension() == fs::path(full).extension() ? full : whole;
    };
    for (const char* file : {"lit.glb", "s.txt", "r.json"}) fs::remove(path(file));
    const bool checkpoint = fs::path(full).extension() == ".ckpt";
    EXPECT_EQ(run(kSolve + fmt::format("--points sensors.txt --points-out {} -o {} --report {} {}",
                                       name("s.txt"), name("lit.glb"), name("r.json"),
                                       checkpoint ? "--checkpoint full.ckpt" : "")),
              kSystemFailure);
    EXPECT_THAT(text("err"), HasSubstr(full));
    // A checkpoint that cannot be kept is told before the work begins.
    for (const char* file : {"lit.glb", "s.txt", "r.json"})
      EXPECT_EQ(fs::exists(path(file)), !checkpoint && name(file) == std::string(file))
          << full << ", " << file;
  }
}

TEST_F(Faults, OneOutputThatFailsKeepsNoOtherOfAnyCommand) {
  keep();
  for (const char* full : {"full.txt", "full.glb", "full.png", "full.exr"})
    fs::create_symlink("/dev/full", path(full));
  struct Case {
    std::string command;
    std::vector<const char*> written;
  };
  for (const Case& c : std::vector<Case>{
           {"sample kept --points sensors.txt --points-out full.txt -o a.glb", {"a.glb"}},
           {"mix kept --points sensors.txt --points-out full.txt -o b.glb", {"b.glb"}},
           {kSolve + "--lightmap 64 -o full.glb", {"full.lightmap.exr", "full.lightmap.png"}},
           {"render kept" + kView + "-o full.png --visibility-mask c.png --mask-samples 2",
            {"c.png"}},
           {"compare kept.png kept.png --feature-size 4 --difference full.exr --mask d.png "
            "--false-colour e.png",
            {"d.png", "e.png"}}}) {
    EXPECT_EQ(run(c.command), kSystemFailure) << c.command;
    EXPECT_THAT(text("err"), HasSubstr("full.")) << c.command;
    for (const char* file : c.written) EXPECT_TRUE(fs::exists(path(file))) << c.command;
  }
  EXPECT_THAT(text("out"), HasSubstr("FBEM")) << "what compare prints is an output, too";
}

TEST_F(Faults, FilesKeepTheirRightsAndLinksWhatTheyLeadTo) {
  folder_.write("private.glb", "what was there");
  fs::permissions(path("private.glb"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_directory(path("elsewhere"));
  folder_.write("elsewhere/real.glb", "what was there");
  fs::create_symlink("elsewhere/real.glb", path("link.glb"));
  ASSERT_EQ(run("scene cornell-box -o private.glb"), 0) << text("err");
  ASSERT_EQ(run("scene cornell-box -o link.glb"), 0) << text("err");
  EXPECT_EQ(fs::status(path("private.glb")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_TRUE(fs::is_symlink(path("link.glb")));
  EXPECT_EQ(text("elsewhere/real.glb"), text("private.glb"));
  EXPECT_EQ(text("elsewhere/real.glb").substr(0, 4), "glTF");
  expect_nothing_unfinished();
}

// As by containers that share a folder: each thinks it has the first process number.
TEST_F(Faults, WritersOfTheSameFileDoNotMeet) {
  ASSERT_EQ(run("scene cornell-box -o box.glb"), 0) << text("err");
  ASSERT_EQ(run("scene furnace -o furnace.glb"), 0) << text("err");
  const std::array<std::string, 2> whole{text("box.glb"), text("furnace.glb")};
  std::vector<std::thread> writers;
  for (const std::string& bytes : whole)
    writers.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        EXPECT_TRUE(check_writable(path("same.glb")));
        EXPECT_TRUE(write_text_atomically(path("same.glb"), bytes));
        EXPECT_THAT(text("same.glb"), AnyOf(whole[0], whole[1]));
      }
    });
  for (std::thread& writer : writers) writer.join();
  expect_nothing_unfinished();
}

class FailingCalls : public Faults {
 protected:
  void SetUp() override {
    Faults::SetUp();
    if (kSanitized) GTEST_SKIP() << "sanitizers have to be loaded first";
  }
  int run_failing(const std::string& arguments, const char* request = nullptr) const {
    return run_under(
        [&] {
          return setenv("LD_PRELOAD", HALFLIGHT_FAILING_CALLS, 1) == 0 &&
                 (!request || setenv("FAILING_ZSTD", request, 1) == 0);
        },
        arguments);
  }
};

TEST_F(FailingCalls, MemoryThatCheckpointsLackIsToldInOneLine) {
  keep();
  for (const char* request : {"1", "2", "3"}) {
    EXPECT_EQ(run_failing(kSolve + "--checkpoint new", request), kSystemFailure) << request;
    EXPECT_THAT(text("err"), HasSubstr("memory"));
    expect_one_line();
  }
  for (const char* request : {"1", "2"}) {
    EXPECT_EQ(run_failing("sample kept --points sensors.txt", request), kSystemFailure) << request;
    EXPECT_THAT(text("err"), HasSubstr("memory"));
    expect_one_line();
  }
  EXPECT_EQ(run_failing("sample kept --points sensors.txt"), 0) << text("err");
  expect_nothing_unfinished();
}

TEST_F(FailingCalls, PageThatCannotBeServedEndsTheLiveView) {
  EXPECT_EQ(run_failing("view room.obj"), kSystemFailure);
  EXPECT_THAT(text("err"), HasSubstr("connections"));
  expect_one_line();
}

TEST_F(Faults, LightmapThatDoesNotFitLeavesThePicturesThatWereThere) {
  ASSERT_EQ(run(kSolve + "-o lit.glb --lightmap 64"), 0) << text("err");
  const std::string exr = text("lit.lightmap.exr"), png = text("lit.lightmap.png");
  ASSERT_GT(exr.size(), 1000u);
  ASSERT_GT(png.size(), 1000u);
  const auto limit = [] { return test::set_limit(RLIMIT_FSIZE, 900); };
  EXPECT_EQ(run_under(limit, kSolve + "-o lit.glb --lightmap 128"), kSystemFailure);
  EXPECT_EQ(text("lit.lightmap.exr"), exr);
  EXPECT_EQ(text("lit.lightmap.png"), png);
  expect_nothing_unfinished();
}

// Commands that were given a name twice by mistake: each tells so and touches nothing.
class NamesGivenTwice : public Faults {
 protected:
  void expect_refused(const std::string& arguments, const std::string& reason) const {
    const auto before = files();
    EXPECT_EQ(run(arguments), 1) << arguments;
    EXPECT_THAT(text("err"), HasSubstr(reason)) << arguments;
    expect_one_line();
    EXPECT_EQ(files(), before) << arguments;
  }
  // Names and bytes, without what the program printed.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      if (entry.is_regular_file()) all[entry.path().filename()] = read_text(entry.path());
    all.erase("out");
    all.erase("err");
    return all;
  }
};

TEST_F(NamesGivenTwice, NoOutputReplacesAnInput) {
  keep();
  ASSERT_EQ(run("scene cornell-box -o box.glb"), 0);
  ASSERT_EQ(run("solve box.glb --feature-size 50cm --progress none --checkpoint box.ckpt"), 0);
  folder_.write("rules.toml", "[[rule]]\nmaterial = \"wall\"\nfeature-size = \"10cm\"\n");
  folder_.write("camera.json", R"({"position": [1, 2, 4], "target": [3, 1, 0]})");
  const std::string box = "solve box.glb --feature-size 50cm ";
  const std::string paths = "reference room.obj --spp 2 --points sensors.txt --points-out ";
  for (const std::string& arguments :
       {box + "-o box.glb", box + "-o ./box.glb", box + "--checkpoint box.glb",
        box + "--report box.glb", kSolve + "--points sensors.txt --points-out sensors.txt",
        kSolve + "--feature-sizes rules.toml --report rules.toml",
        kSolve + "--importance camera.json --report camera.json",
        std::string("solve room.obj --feature-size 9px@camera.json --report camera.json"),
        std::string("sample kept -o kept"), std::string("sample box.ckpt -o box.glb"),
        std::string("mix kept -o kept"), std::string("mix kept -o room.obj"), paths + "sensors.txt",
        paths + "room.obj", "render kept" + kView + "-o kept.png --visibility-mask kept.png",
        std::string("compare kept.png kept.png --difference kept.png"),
        std::string("compare kept.png kept.png --mask kept.png --feature-size 4")})
    expect_refused(arguments, "would replace");
}

TEST_F(NamesGivenTwice, NoTwoOutputsHaveOneName) {
  keep();
  for (const std::string& arguments :
       {kSolve + "-o same.glb --report same.glb", kSolve + "-o same.glb --report ./same.glb",
        kSolve + "-o a/../same.glb --checkpoint same.glb",
        kSolve + "-o lit.glb --lightmap 64 --report lit.lightmap.exr",
        std::string("compare kept.png kept.png --feature-size 1 --feature-size 2 --mask m.png "
                    "--difference m-2.png"),
        std::string("compare kept.png kept.png --feature-size 1 --feature-size 1.0000001 --mask "
                    "m.png")})
    expect_refused(arguments, "would replace what");
}

TEST_F(NamesGivenTwice, LinksAreNames) {
  fs::create_symlink("room.obj", path("soft.obj"));
  fs::create_hard_link(path("room.obj"), path("hard.obj"));
  fs::create_directory_symlink(".", path("here"));
  for (const char* name : {"soft.obj", "hard.obj", "here/room.obj"})
    expect_refused(kSolve + "-o " + name, "would replace the scene");
  expect_refused(kSolve + "-o here/new.glb --report new.glb", "would replace what -o writes");
}

TEST_F(NamesGivenTwice, FilesThatASceneNamesAreInputs) {
  expect_refused(kSolve + "-o room.mtl", "would replace a file of the scene");
  folder_.write("room.mtl", std::string(kRoomMaterials) + "map_Kd -s 2 2 1 old wood.png\n");
  folder_.write("old wood.png", "no picture");
  expect_refused("render room.obj --path-trace 1" + kView + "-o 'old wood.png'",
                 "would replace a file of the scene");
  ASSERT_EQ(run("scene cornell-box -o box.glb"), 0);
  test::GlbFile box(path("box.glb"));
  box.document["buffers"][0]["uri"] = "box%20of \"one\".bin";
  folder_.write("box.gltf", box.document.dump());
  folder_.write("box of \"one\".bin", std::string(box.binary.begin(), box.binary.end()));
  expect_refused("solve box.gltf -o 'box of \"one\".bin'", "would replace a file of the scene");
}

TEST_F(NamesGivenTwice, DevicesAndTheCheckpointGoneOnFromMayBe) {
  const std::string all = kSolve + "--points sensors.txt --points-out ";
  EXPECT_EQ(run(all + "/dev/null -o /dev/null --report /dev/null"), 0) << text("err");
  EXPECT_EQ(run(kSolve + "--checkpoint c"), 0) << text("err");
  EXPECT_EQ(run(kSolve + "--checkpoint c --resume -o lit.glb"), 0) << text("err");
  EXPECT_EQ(run(all + "/dev/stdout"), 0) << text("err");
  EXPECT_EQ(irradiance_of(text("out")).size(), 300u);
  EXPECT_TRUE(fs::is_symlink("/dev/stdout"));
}

TEST_F(Faults, FolderInPlaceOfADerivedNameIsToldBeforeAnyWork) {
  keep();
  for (const char* name : {"lit.lightmap.exr", "other.lightmap.png", "m-2.png"})
    fs::create_directory(path(name));
  const std::string compare = "compare kept.png kept.png --feature-size 1 --feature-size 2 ";
  for (const std::string& arguments :
       {kSolve + "-o lit.glb --lightmap 64 --checkpoint c",
        kSolve + "-o other.glb --lightmap 64 --checkpoint c",
        std::string("sample kept -o lit.glb --lightmap 64"),
        std::string("mix kept -o other.glb --lightmap 64"), compare + "--mask m.png",
        compare + "--false-colour m.png"}) {
    EXPECT_EQ(run(arguments), kSystemFailure) << arguments;
    EXPECT_THAT(text("err"), HasSubstr("Is a directory")) << arguments;
    expect_one_line();
  }
  for (const char* name : {"lit.glb", "c", "other.lightmap.exr", "m-1.png"})
    EXPECT_FALSE(fs::exists(path(name))) << name;
  EXPECT_EQ(run("reproduce figure2 -o sensors.txt"), kSystemFailure);
  expect_one_line();
  fs::create_directories(path("pages/numbers.json"));
  EXPECT_EQ(run("reproduce figure2 -o pages"), kSystemFailure);
  expect_one_line();
}

TEST_F(Faults, NamesMayBeAsLongAsTheSystemAllows) {
  for (const std::size_t length : {239, 245, 255}) {
    const std::string name(length - 4, 'x');
    EXPECT_EQ(run("scene cornell-box -o " + name + ".glb"), 0) << text("err");
    EXPECT_GT(text(name + ".glb").size(), 1000u);
  }
  std::string umlauts;
  while (umlauts.size() < 250) umlauts += "\u00e4";
  EXPECT_EQ(run("scene cornell-box -o " + umlauts + ".glb"), 0) << text("err");
  EXPECT_EQ(run(kSolve + "--checkpoint c -o " + std::string(252, 'x') + ".glb"), kSystemFailure);
  EXPECT_THAT(text("err"), HasSubstr("File name too long"));
  expect_one_line();
  EXPECT_FALSE(fs::exists(path("c")));
  expect_nothing_unfinished();
}

// A scene of two files, as exporters write them.
class VanishingInput : public Faults {
 protected:
  void SetUp() override {
    Faults::SetUp();
    ASSERT_EQ(run("scene cornell-box -o box.glb"), 0);
    test::GlbFile box(path("box.glb"));
    box.document["buffers"][0]["uri"] = "box.bin";
    folder_.write("box.gltf", box.document.dump());
    binary_.assign(box.binary.begin(), box.binary.end());
    folder_.write("box.bin", binary_);
    ASSERT_EQ(run("inspect box.gltf"), 0) << text("err");
  }
  std::string binary_;
};

TEST_F(VanishingInput, IsToldInOneLine) {
  for (const std::string& content : {binary_.substr(0, binary_.size() / 2), std::string()}) {
    folder_.write("box.bin", content);
    EXPECT_EQ(run("inspect box.gltf"), 1);
    expect_one_line();
  }
  fs::remove(path("box.bin"));
  EXPECT_EQ(run("solve box.gltf --report r.json"), 1);
  EXPECT_THAT(text("err"), HasSubstr("box.bin"));
  expect_one_line();
  EXPECT_FALSE(fs::exists(path("r.json")));
}

TEST_F(VanishingInput, WhileItIsReadNeverCrashes) {
  std::atomic<bool> end{false};
  std::thread changing([&] {
    for (std::uint64_t i = 0; !end; ++i) {
      if (i % 3 == 0)
        fs::remove(path("box.bin"));
      else
        folder_.write("box.bin", binary_.substr(0, i % 3 == 1 ? binary_.size() : hash(i) % 1000));
      std::this_thread::sleep_for(std::chrono::microseconds(hash(i, 1) % 3000));
    }
  });
  std::array<int, 3> ends{};
  for (int i = 0; i < 60; ++i) {
    const int status = run("inspect box.gltf");
    ASSERT_THAT(status, AnyOf(0, 1, kSystemFailure)) << text("err");
    ++ends[static_cast<std::size_t>(status)];
    if (status != 0) expect_one_line();
  }
  end = true;
  changing.join();
  EXPECT_GT(ends[1], 0);
}

TEST_F(Faults, MemoryThatRunsOutIsToldInOneLine) {
  if (kSanitized) GTEST_SKIP() << "sanitizers reserve more than any limit";
  const std::string command =
      "solve room.obj --feature-size 3cm --progress none -o lit.glb --points sensors.txt "
      "--points-out s.txt --report r.json";
  int ended = 0, out_of_memory = 0;
  for (std::size_t mebibytes = 64; mebibytes <= 448; mebibytes += 6) {
    const auto limit = [&] { return test::set_limit(RLIMIT_AS, mebibytes << 20); };
    if (run_under(limit, "--version") != 0) continue;  // the libraries alone take more
    const int status = run_under(limit, command);
    ASSERT_THAT(status, AnyOf(0, kSystemFailure)) << mebibytes << " MiB: " << text("err");
    ++(status == 0 ? ended : out_of_memory);
    if (status == kSystemFailure) {
      EXPECT_THAT(text("err"), AnyOf(HasSubstr("memory"), HasSubstr("Resource")));
      expect_one_line();
    }
    expect_nothing_unfinished();
  }
  EXPECT_GT(ended, 0);
  EXPECT_GT(out_of_memory, 10);
}

class FewThreads : public Faults {
 protected:
  // The folder and a copy of the program, for anyone to use.
  void SetUp() override {
    Faults::SetUp();
    if (kSanitized) GTEST_SKIP() << "sanitizers start threads of their own";
    fs::permissions(folder_.path(), fs::perms::all);
    fs::copy_file(HALFLIGHT_BINARY, path("halflight"));
    fs::permissions(path("halflight"), fs::perms::all);
  }
  int run_with(std::size_t threads, const std::string& arguments) const {
    for (const char* name : {"out", "err"}) {
      std::ofstream(path(name), std::ios::trunc);
      fs::permissions(path(name), fs::perms::all);
    }
    return test::run_limited(folder_.path(), "./halflight", arguments,
                             [&] { return test::limit_threads(threads); });
  }
};

TEST_F(FewThreads, AreEnoughForTheSameLight) {
  const std::string command = kSolve + "--threads 8 --points sensors.txt";
  ASSERT_EQ(run(command + " -o all.glb"), 0);
  const std::string all = text("out"), lit = text("all.glb");
  for (const std::size_t threads : {1, 2, 3, 5}) {
    const int status = run_with(threads, command + " -o few.glb");
    if (status == kCannotPrepare) GTEST_SKIP() << "no other user can be taken on";
    EXPECT_EQ(status, 0) << threads << " threads: " << text("err");
    EXPECT_EQ(text("out"), all);
    EXPECT_TRUE(text("few.glb") == lit);
    fs::remove(path("few.glb"));
  }
}

TEST_F(FewThreads, AreToldWhereMoreAreNeeded) {
  const int status = run_with(1, kSolve + "--time 20s --points sensors.txt");
  if (status == kCannotPrepare) GTEST_SKIP() << "no other user can be taken on";
  EXPECT_EQ(status, kSystemFailure) << text("err");
  EXPECT_THAT(text("err"), HasSubstr("threads"));
  expect_one_line();
  for (const std::size_t threads : {1, 3, 12}) {
    EXPECT_EQ(run_with(threads, "view room.obj"), kSystemFailure);
    EXPECT_THAT(text("err"), HasSubstr("threads"));
    expect_one_line();
  }
}

// The clock on the wall goes mad; a deadline of two seconds does not.
TEST_F(Faults, DeadlinesDoNotReadTheClockOnTheWall) {
  const char* library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";
  if (kSanitized || !fs::exists(library)) GTEST_SKIP() << "libfaketime cannot be used here";
  ASSERT_EQ(run("scene office --count 100 -o office.glb"), 0);
  for (const char* clock : {"+0 x5000", "@2001-01-01 00:00:00", "+0 x0.01"}) {
    const auto fake = [&] {
      return setenv("LD_PRELOAD", library, 1) == 0 && setenv("FAKETIME", clock, 1) == 0 &&
             setenv("FAKETIME_DONT_FAKE_MONOTONIC", "1", 1) == 0;
    };
    const auto start = std::chrono::steady_clock::now();
    const int status = run_under(fake,
                                 "solve office.glb --feature-size 3mm --error 0.2% --progress none "
                                 "--time 2s --report r.json");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(status, 4) << clock << ": " << text("err");
    EXPECT_GT(took.count(), 1.0) << clock;
    EXPECT_LT(took.count(), 15.0) << clock;
    const double reported = read_json(path("r.json"))["wall_seconds"].get<double>();
    EXPECT_GT(reported, 1.0) << clock;
    EXPECT_LT(reported, took.count()) << clock;
  }
}

}  // namespace
}  // namespace halflight
