#include "halflight/base/quantities.h"

#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>

namespace halflight {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};

// A positive number and one of the units, within single precision; the empty name is the unit that
// may be left out.
Result<double> parse(std::string_view text, std::span<const Unit> units, const char* kind,
                     const char* remedy) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string_view suffix(end, text.data() + text.size());
  constexpr double kLargest{std::numeric_limits<float>::max()};
  if (error == std::errc() && number >= 0.0)
    for (const Unit& unit : units)
      if (suffix == unit.name && number * unit.factor <= kLargest) return number * unit.factor;
  return input_error(fmt::format("'{}' is not a {}", text, kind), {}, remedy);
}

}  // namespace

Result<double> parse_length(std::string_view text) {
  constexpr std::array<Unit, 6> units{
      {{"", 1.0}, {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};
  return parse(text, units, "length", "write it like 5cm, 0.05 or 2in");
}

Result<double> parse_duration(std::string_view text) {
  constexpr std::array<Unit, 5> units{
      {{"", 1.0}, {"s", 1.0}, {"ms", 0.001}, {"m", 60.0}, {"h", 3600.0}}};
  return parse(text, units, "duration", "write it like 10s, 2m or 500ms");
}

Result<double> parse_percent(std::string_view text) {
  constexpr std::array<Unit, 2> units{{{"", 0.01}, {"%", 0.01}}};
  return parse(text, units, "percentage", "write it like 5%");
}

Result<double> parse_count(std::string_view text) {
  constexpr std::array<Unit, 3> units{{{"", 1.0}, {"k", 1e3}, {"M", 1e6}}};
  return parse(text, units, "count", "write it like 250000, 250k or 2M");
}

Result<double> parse_size(std::string_view text) {
  constexpr std::array<Unit, 10> units{{{"", 1.0},
                                        {"B", 1.0},
                                        {"kB", 1e3},
                                        {"MB", 1e6},
                                        {"GB", 1e9},
                                        {"TB", 1e12},
                                        {"KiB", 0x1p10},
                                        {"MiB", 0x1p20},
                                        {"GiB", 0x1p30},
                                        {"TiB", 0x1p40}}};
  return parse(text, units, "size", "write it like 2GiB or 500MB");
}

}  // namespace halflight
