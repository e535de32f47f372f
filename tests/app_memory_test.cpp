// --memory from outside: the process stays below it, or says at once that it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "limited_run.h"
#include "room_command.h"
#include "sanitized.h"
#include "shared_scenes.h"

namespace halflight {
namespace {

using test::kSanitized;
using ::testing::HasSubstr;

class MemoryCommand : public RoomCommand {
 protected:
  std::string one_line_error(const std::string& arguments) const {
    EXPECT_EQ(run(arguments), 1) << arguments;
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    return err;
  }
};

TEST_F(MemoryCommand, TheProcessStaysBelowTheLimit) {
  if (kSanitized) GTEST_SKIP() << "sanitizers keep what is freed";
  const std::string solve =
      "solve room.obj --feature-size 4mm --progress none --report r.json --memory ";
  double least_links = 1e18;
  for (const char* limit : {"4GiB", "46MiB"}) {
    const bool generous = std::string(limit) == "4GiB";
    ASSERT_EQ(run(solve + limit), generous ? 0 : 4) << text("err");
    const auto report = read_json(path("r.json"));
    const double most = report["memory"]["limit"].get<double>();
    EXPECT_LE(report["peak_rss_bytes"].get<double>(), most);
    EXPECT_EQ(report["memory"]["made_coarser"].get<bool>(), !generous);
    EXPECT_LT(report["links"].get<double>(), least_links);
    EXPECT_GT(report["links"].get<double>(), 0.0);
    least_links = report["links"].get<double>();
  }
}

TEST_F(MemoryCommand, TheLitSceneStaysBelowTheLimit) {
  if (kSanitized) GTEST_SKIP() << "sanitizers keep what is freed";
  ASSERT_EQ(run("scene loose-triangles --count 3000 -o loose.glb"), 0) << text("err");
  const int status =
      run("solve loose.glb --feature-size 10cm --error 30% --progress none "
          "--report r.json --memory 120MiB -o lit.glb --lightmap 256");
  EXPECT_TRUE(status == 0 || status == 4) << text("err");
  const auto report = read_json(path("r.json"));
  EXPECT_LE(report["peak_rss_bytes"].get<double>(), report["memory"]["limit"].get<double>());
  EXPECT_GT(text("lit.glb").size(), 1000u);
}

TEST_F(MemoryCommand, SaysWhatItNeeds) {
  EXPECT_THAT(one_line_error("solve room.obj --memory 1MiB --report r.json"),
              HasSubstr("at least"));
  EXPECT_THAT(one_line_error("solve room.obj --memory 100 --report r.json"), HasSubstr("read"));
  EXPECT_THAT(one_line_error("solve room.obj --memory 80MiB -o lit.glb --lightmap 4096"),
              HasSubstr("-o"));
  for (const char* size : {"0", "-1", "much", "2Gi"})
    EXPECT_THAT(one_line_error(std::string("solve room.obj --report r.json --memory ") + size),
                HasSubstr("--memory"));
}

}  // namespace
}  // namespace halflight
