// Numbers on the command line: checks, and options that several commands have.
#pragma once

#include <cerrno>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace halflight::app {

// A number from least to most. NaN is none, and neither is what the type cannot hold: -1 or 1e20
// for an unsigned type, of which CLI11 makes its largest number.
template <class Number>
CLI::Validator from_to(Number least, Number most) {
  return CLI::Validator(
      [least, most](const std::string& text) {
        Number value{};
        errno = 0;
        const bool read = CLI::detail::lexical_cast(text, value) &&
                          (std::is_floating_point_v<Number> || errno != ERANGE) &&
                          (std::is_signed_v<Number> || text.find('-') == std::string::npos);
        return read && value >= least && value <= most
                   ? std::string()
                   : fmt::format("'{}' is not a number from {} to {}", text, least, most);
      },
      "");
}

// Any that the type holds.
template <class Number>
CLI::Validator any_number() {
  return from_to(std::numeric_limits<Number>::lowest(), std::numeric_limits<Number>::max());
}

inline void add_threads(CLI::App& command, int& threads) {
  constexpr int kMostThreads = 4096;
  command.add_option("--threads", threads, "0: all cores")
      ->check(from_to(0, kMostThreads))
      ->type_name("N")
      ->capture_default_str();
}

inline void add_seed(CLI::App& command, std::uint64_t& seed) {
  command.add_option("--seed", seed, "picks another set of samples")
      ->check(any_number<std::uint64_t>())
      ->type_name("N")
      ->capture_default_str();
}

}  // namespace halflight::app
