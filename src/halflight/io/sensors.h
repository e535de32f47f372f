// Sensor files: one sensor a line, "x y z nx ny nz", in the scene file's own coordinates.
// Blank lines and what follows a '#' are skipped; columns after the sixth are ignored, so that a
// result file can be read as a sensor file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/base/vec.h"

namespace halflight {

// Double precision: what is printed is what was read.
struct Sensor {
  glm::dvec3 position{0.0};          // file coordinates
  glm::dvec3 normal{0.0, 1.0, 0.0};  // any length but 0
};

struct WorldSensor {
  Vec3 position{0.f};          // metres, +Y up
  Vec3 normal{0.f, 1.f, 0.f};  // unit
};

Result<std::vector<Sensor>> read_sensors(const std::filesystem::path& path);
// `where` names the text in messages.
Result<std::vector<Sensor>> parse_sensors(std::string_view text, const std::string& where);

// `to_world` is Scene::to_world: a rotation with a uniform scale.
WorldSensor to_world(const Mat4& to_world, const Sensor& sensor);

// The sensors, each followed by "Er Eg Eb" and, where errors are given, one more column. Numbers
// are the shortest that read back as the same value.
std::string sensor_table(std::span<const Sensor> sensors, std::span<const Rgb> irradiance,
                         std::span<const float> standard_errors = {});

// Writes a table to a file (whole or not at all), or to stdout when the path is empty.
Result<void> write_sensor_table(const std::filesystem::path& path, const std::string& table);

}  // namespace halflight
