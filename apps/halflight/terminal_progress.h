// Progress on stderr, where somebody watches it.
#pragma once

#include <cstdio>
#include <string>

#include <unistd.h>

#include "halflight/base/progress.h"

namespace halflight::app {

// One line that counts up to 100 %; silent when stderr is no terminal.
inline Progress::Listener terminal_progress() {
  if (::isatty(STDERR_FILENO) == 0) return {};
  return [](std::string_view phase, double share) {
    std::fprintf(stderr, "\r%.*s %3.0f %%%s", static_cast<int>(phase.size()), phase.data(),
                 100.0 * share, share >= 1.0 ? "\n" : "");
  };
}

}  // namespace halflight::app
