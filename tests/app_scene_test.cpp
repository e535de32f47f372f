#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "gltf_check.h"
#include "halflight/scene/procedural/catalogue.h"

namespace halflight {
namespace {

namespace fs = std::filesystem;

// A folder of its own for the files of one test.
class SceneCommand : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("halflight_scene_") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Exit status of the program, run in the folder; what it prints goes to files "out" and "err".
  int run(const std::string& arguments) const {
    const std::string line = "cd '" + folder_.string() + "' && '" HALFLIGHT_BINARY "' scene " +
                             arguments + " >out 2>err";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  bool exists(const std::string& name) const { return fs::exists(path(name)); }
  fs::path path(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

TEST_F(SceneCommand, ListsEverySceneOnALineOfItsOwn) {
  EXPECT_EQ(run("list"), 0);
  const std::string out = read("out");
  const std::vector<Recipe> recipes = scene_recipes();
  EXPECT_EQ(std::count(out.begin(), out.end(), '\n'), static_cast<long>(recipes.size()));
  for (const Recipe& recipe : recipes) EXPECT_NE(out.find(recipe.name), std::string::npos);
}

TEST_F(SceneCommand, WritesABinaryGltfNamedAfterTheScene) {
  EXPECT_EQ(run("furnace"), 0);
  EXPECT_EQ(read("furnace.glb").substr(0, 4), "glTF");
  EXPECT_EQ(read("out"), "");
}

TEST_F(SceneCommand, EveryDefaultSceneIsValidGltf) {
  if (!test::have_gltf_validator()) GTEST_SKIP() << "the glTF validator is not installed";
  for (const Recipe& recipe : scene_recipes()) {
    EXPECT_EQ(run(recipe.name), 0);
    EXPECT_TRUE(test::is_valid_gltf(path(recipe.name + ".glb"))) << recipe.name;
  }
}

TEST_F(SceneCommand, TheSameParametersGiveTheSameBytes) {
  EXPECT_EQ(run("office --count 50 --seed 3 -o a.glb"), 0);
  EXPECT_EQ(run("office --count 50 --seed 3 -o b.glb"), 0);
  EXPECT_EQ(run("office --count 50 --seed 4 -o c.glb"), 0);
  EXPECT_EQ(read("a.glb"), read("b.glb"));
  EXPECT_NE(read("a.glb"), read("c.glb"));
}

TEST_F(SceneCommand, RejectsWhatItCannotBuildAndWritesNothing) {
  EXPECT_EQ(run("ballroom"), 1);
  EXPECT_NE(read("err").find("there is no built-in scene 'ballroom'"), std::string::npos);
  EXPECT_EQ(run(""), 1);
  EXPECT_EQ(run("office --count -3"), 1);
  EXPECT_EQ(run("office --count many"), 1);
  EXPECT_EQ(run("furnace --reflectance 1.5"), 1);
  EXPECT_NE(read("err").find("reflectance"), std::string::npos);
  EXPECT_EQ(run("furnace --reflectance nan"), 1);
  EXPECT_NE(read("err").find("'nan' is not a number from 0 to"), std::string::npos) << read("err");
  EXPECT_EQ(run("loose-triangles --size nan"), 1);
  EXPECT_EQ(run("office --count 99999999999999999999"), 1);
  EXPECT_FALSE(exists("loose-triangles.glb"));
  EXPECT_FALSE(exists("office.glb"));
  EXPECT_FALSE(exists("furnace.glb"));
}

TEST_F(SceneCommand, AnUnwritablePlaceIsASystemFailure) {
  EXPECT_EQ(run("furnace -o no/such/folder/f.glb"), 2);
  EXPECT_NE(read("err").find("no/such/folder"), std::string::npos);
}

}  // namespace
}  // namespace halflight
