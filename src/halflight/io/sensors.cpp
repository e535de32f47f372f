#include "halflight/io/sensors.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>

#include <fmt/format.h>

#include "halflight/base/one_line.h"
#include "halflight/io/atomic_file.h"
#include "halflight/io/read_file.h"

namespace halflight {
namespace {

constexpr std::string_view kSpaces = " \t\r\v\f,;";
constexpr std::size_t kColumns = 6;
// Rays begin and end within 1e18 m, and no unit is longer than 1 km; squares of shorter normals are
// not exact.
constexpr double kLargest = 1e12, kShortestNormal = 1e-100;

// The numbers of one line without its comment.
Result<std::vector<double>> numbers(std::string_view line, const std::string& where) {
  line = line.substr(0, line.find('#'));
  std::vector<double> values;
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
    if (line.empty()) return values;
    const std::string_view word = line.substr(0, line.find_first_of(kSpaces));
    line.remove_prefix(word.size());
    const char* first = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* last = word.data() + word.size();
    double value = 0.0;
    const auto [end, error] = std::from_chars(first, last, value);
    const bool is_position = values.size() < kColumns;
    if (error != std::errc() || end != last || (is_position && !(std::abs(value) < kLargest)))
      return input_error(fmt::format("'{}' is not a number that can be used", one_line(word, 40)),
                         where, "a sensor is x y z nx ny nz");
    values.push_back(value);
  }
}

Result<Sensor> to_sensor(const std::vector<double>& v, const std::string& where) {
  if (v.size() < kColumns)
    return input_error(fmt::format("{} numbers instead of 6", v.size()), where,
                       "a sensor is x y z nx ny nz");
  const Sensor sensor{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  if (!(glm::length(sensor.normal) > kShortestNormal))
    return input_error("the normal has no length", where,
                       "let nx ny nz point to the side that the sensor reads");
  return sensor;
}

}  // namespace

Result<std::vector<Sensor>> read_sensors(const std::filesystem::path& path) {
  const Result<Bytes> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_sensors(as_text(*bytes), path.string());
}

Result<std::vector<Sensor>> parse_sensors(std::string_view text, const std::string& where) {
  std::vector<Sensor> sensors;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string place = fmt::format("{}:{}", where, line_number);
    const auto values = numbers(text.substr(0, length), place);
    text.remove_prefix(std::min(length + 1, text.size()));
    if (!values) return tl::unexpected(values.error());
    if (values->empty()) continue;
    const Result<Sensor> sensor = to_sensor(*values, place);
    if (!sensor) return tl::unexpected(sensor.error());
    sensors.push_back(*sensor);
  }
  if (sensors.empty())
    return input_error("the file holds no sensor", where, "write one x y z nx ny nz a line");
  return sensors;
}

WorldSensor to_world(const Mat4& to_world, const Sensor& sensor) {
  const glm::dvec3 normal(to_world * glm::dvec4(glm::normalize(sensor.normal), 0.0));
  return {Vec3(to_world * glm::dvec4(sensor.position, 1.0)), Vec3(glm::normalize(normal))};
}

std::string sensor_table(std::span<const Sensor> sensors, std::span<const Rgb> irradiance,
                         std::span<const float> standard_errors) {
  std::string table;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const auto& [p, n] = sensors[i];
    const Rgb& e = irradiance[i];
    auto out = std::back_inserter(table);
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {}", p.x, p.y, p.z, n.x, n.y, n.z, e.r, e.g, e.b);
    if (!standard_errors.empty()) fmt::format_to(out, " {}", standard_errors[i]);
    table += '\n';
  }
  return table;
}

Result<void> write_sensor_table(const std::filesystem::path& path, const std::string& table) {
  if (!path.empty()) return write_file_atomically(path, std::as_bytes(std::span(table)));
  const bool written = std::fwrite(table.data(), 1, table.size(), stdout) == table.size();
  if (!written || std::fflush(stdout) != 0)
    return system_error("cannot write the sensors to the standard output");
  return {};
}

}  // namespace halflight
