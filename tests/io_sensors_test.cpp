#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "halflight/io/sensors.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

class SensorFiles : public ::testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
};

TEST_F(SensorFiles, CommentsBlankLinesAndFurtherColumnsAreSkipped) {
  const auto file = folder_.write("s.txt",
                                  "# six columns\r\n"
                                  "1 2 3 0 1 0\n"
                                  "\n"
                                  "  -1.5e-3\t+2 3   0 0 -2  # normal of length 2\n"
                                  "4,5,6, 1,0,0\n"
                                  "7 8 9 1 0 0 0.5 0.25 0.125 0.01");
  const auto sensors = read_sensors(file);
  ASSERT_TRUE(sensors) << sensors.error().line();
  ASSERT_EQ(sensors->size(), 4u);
  EXPECT_EQ((*sensors)[1].position, glm::dvec3(-1.5e-3, 2.0, 3.0));
  EXPECT_EQ((*sensors)[2].position, glm::dvec3(4.0, 5.0, 6.0));
  EXPECT_EQ((*sensors)[3].normal, glm::dvec3(1.0, 0.0, 0.0));
}

TEST_F(SensorFiles, ErrorsNameFileAndLine) {
  const auto message = [&](const std::string& text) {
    const auto sensors = read_sensors(folder_.write("s.txt", text));
    return sensors ? std::string("no error") : sensors.error().line();
  };
  EXPECT_THAT(message("1 2 3 0 1 0\n1 2 3 0 1\n"), HasSubstr("s.txt:2: 5 numbers"));
  EXPECT_THAT(message("\n\n1 2 x3 0 1 0\n"), HasSubstr("s.txt:3: 'x3'"));
  EXPECT_THAT(message("1 2 nan 0 1 0\n"), HasSubstr("s.txt:1: 'nan'"));
  EXPECT_THAT(message("1 2 3 0 0 0\n"), HasSubstr("s.txt:1: the normal has no length"));
  EXPECT_THAT(message("# nothing\n"), HasSubstr("holds no sensor"));
  // Rays cannot begin there, and a square of the normal is not exact.
  EXPECT_THAT(message("2e18 2 3 0 1 0\n"), HasSubstr("s.txt:1: '2e18'"));
  EXPECT_THAT(message("1 2 3 1e-155 0 0\n"), HasSubstr("s.txt:1: the normal has no length"));
  EXPECT_THAT(message("1e400 2 3 0 1 0\n"), HasSubstr("s.txt:1: '1e400'"));
  const auto absent = read_sensors(path("absent.txt"));
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().line(), HasSubstr("absent.txt"));
}

TEST_F(SensorFiles, PrintedNumbersReadBackAsTheSameValues) {
  const std::vector<Sensor> sensors{{{0.1, 1.0 / 3.0, 1e-17}, {0.0, -1.0, 0.0}}};
  const std::vector<Rgb> irradiance{Rgb(0.1f, 1e-9f, 12345.678f)};
  const std::vector<float> errors{0.015f};
  const std::string table = sensor_table(sensors, irradiance, errors);
  EXPECT_EQ(table, "0.1 0.3333333333333333 1e-17 0 -1 0 0.1 1e-09 12345.678 0.015\n");
  const auto back = read_sensors(folder_.write("s.txt", table));
  ASSERT_TRUE(back);
  EXPECT_EQ((*back)[0].position, sensors[0].position);
}

TEST(Sensors, AreTakenFromTheFilesCoordinatesToTheWorld) {
  // Centimetres, z up: x -> x, y -> -z, z -> y.
  const Mat4 file_to_world(glm::dvec4(.01, 0, 0, 0), glm::dvec4(0, 0, -.01, 0),
                           glm::dvec4(0, .01, 0, 0), glm::dvec4(0, 0, 0, 1));
  const WorldSensor s = to_world(file_to_world, {{100.0, 200.0, 300.0}, {0.0, 0.0, 5.0}});
  EXPECT_NEAR(glm::distance(s.position, Vec3(1.f, 3.f, -2.f)), 0.f, 1e-6f);
  EXPECT_NEAR(glm::distance(s.normal, Vec3(0.f, 1.f, 0.f)), 0.f, 1e-6f);
}

}  // namespace
}  // namespace halflight
