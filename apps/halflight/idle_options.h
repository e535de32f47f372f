// Options that were given and change nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "commands.h"

namespace halflight::app {

// A warning of one line that names those of `options` that were given; `where` says where they have
// no effect: "without --points".
inline void warn_of_idle(const CLI::App& command, const std::vector<std::string>& options,
                         std::string_view where) {
  std::string given;
  int count = 0;
  for (const std::string& option : options)
    if (command.get_option(option)->count() > 0) given += (count++ > 0 ? ", " : "") + option;
  if (count == 1) warn(fmt::format("{} has no effect {} (leave it out)", given, where));
  if (count > 1) warn(fmt::format("{} have no effect {} (leave them out)", given, where));
}

}  // namespace halflight::app
