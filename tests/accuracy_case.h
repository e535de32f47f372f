// Scenes with known light, solved as a user would: `halflight solve` with default settings, light
// read by sensors. Each case prints one row of the table in docs/accuracy.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "closed_forms.h"
#include "halflight/io/write_gltf.h"
#include "quad_scene.h"
#include "room_command.h"

namespace halflight::testing {

struct KnownLight {
  Point position, normal;
  double irradiance = 0.0;  // what it must be
};

class AccuracyCase : public RoomCommand {
 protected:
  // Irradiance at each point; empty after a failure.
  std::vector<double> solved(const QuadScene& scene, const std::vector<KnownLight>& points) const {
    const auto written = write_scene_glb(path("case.glb"), scene.scene);
    EXPECT_TRUE(written) << written.error().line();
    std::string lines;
    for (const KnownLight& k : points)
      lines += fmt::format("{} {} {} {} {} {}\n", k.position.x, k.position.y, k.position.z,
                           k.normal.x, k.normal.y, k.normal.z);
    folder_.write("points.txt", lines);
    // Of the scene file the sky is not a part.
    const Rgb sky = scene.scene.sky;
    EXPECT_EQ(run(fmt::format("solve case.glb --sky {},{},{} --progress none --points points.txt",
                              sky.r, sky.g, sky.b)),
              0)
        << text("err");
    const std::vector<float> channels = irradiance_of(text("out"));
    EXPECT_EQ(channels.size(), 3 * points.size());
    std::vector<double> irradiance;
    if (channels.size() != 3 * points.size()) return irradiance;
    for (std::size_t i = 0; i < channels.size(); i += 3)
      irradiance.push_back(static_cast<double>(channels[i + 1]));
    return irradiance;
  }

  // The largest error of any point, as a share of what it must be.
  void expect_at_points(const std::string& name, const QuadScene& scene,
                        const std::vector<KnownLight>& points, double tolerance) const {
    const std::vector<double> irradiance = solved(scene, points);
    double worst = 0.0;
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      const double error = irradiance[i] / points[i].irradiance - 1.0;
      EXPECT_LT(std::abs(error), tolerance)
          << name << ", point " << i << ": " << irradiance[i] << " for " << points[i].irradiance;
      worst = std::max(worst, std::abs(error));
    }
    print_row(name, fmt::format("worst of {} points", points.size()), tolerance, worst);
  }

  static void expect_value(const std::string& name, const std::string& what, double value,
                           double expected, double tolerance) {
    const double error = std::abs(value / expected - 1.0);
    EXPECT_LT(error, tolerance) << name << ": " << value << " for " << expected;
    print_row(name, what, tolerance, error);
  }

 private:
  static void print_row(const std::string& name, const std::string& what, double tolerance,
                        double error) {
    std::printf("| %s | %s | %.1f %% | %.2f %% |\n", name.c_str(), what.c_str(), 100.0 * tolerance,
                100.0 * error);
  }
};

}  // namespace halflight::testing
