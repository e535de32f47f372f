// Quantities as people write them on the command line.
#pragma once

#include <string_view>

#include "halflight/base/result.h"

namespace halflight {

// Metres: squares of lengths in between are neither 0 nor infinite in single precision.
inline constexpr double kShortestLength = 1e-15, kLongestLength = 1e15;

Result<double> parse_length(std::string_view text);    // "0.05", "5cm", "2in": metres
Result<double> parse_duration(std::string_view text);  // "10", "10s", "2m", "500ms": seconds
Result<double> parse_percent(std::string_view text);   // "5%", "5": 0.05
Result<double> parse_count(std::string_view text);     // "250000", "250k", "2M"

Result<double> parse_size(std::string_view text);  // "2GiB", "500MB", "1048576": bytes

}  // namespace halflight
