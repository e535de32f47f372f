// The options of a solve by name, as text: what a checkpoint remembers and compares.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "halflight/solve/solver.h"

namespace halflight {

inline constexpr float kLeastError = 1e-6f, kLargestError = 100.f;  // that can be aimed at

// One line "name value" for each option; numbers are the shortest that read back the same.
std::string to_text(const SolveOptions& options);
// None where a line is missing, unknown or out of range.
std::optional<SolveOptions> parse_settings(std::string_view text);

// The first that differs, in words: "error is 0.02 there and 0.05 here"; empty: none does.
std::string difference(const SolveOptions& there, const SolveOptions& here);

}  // namespace halflight
