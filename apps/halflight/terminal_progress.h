// Progress on stderr, where somebody watches it.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include <unistd.h>

#include "halflight/base/progress.h"

namespace halflight::app {

// One line with a bar and the time left in the phase; silent when stderr is no terminal.
inline Progress::Listener terminal_progress() {
  if (::isatty(STDERR_FILENO) == 0) return {};
  using Clock = std::chrono::steady_clock;
  return [phase_name = std::string(), start = Clock::now()](std::string_view phase,
                                                            double share) mutable {
    if (phase != phase_name) {
      phase_name = phase;
      start = Clock::now();
    }
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(kWidth * share);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double left = share > 0.02 ? seconds * (1.0 - share) / share : 0.0;
    std::fprintf(stderr, "\r%-10s [%s%s] %3.0f %%, %.0f s left \033[K%s", phase_name.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), ' ').c_str(), 100.0 * share,
                 left, share >= 1.0 ? "\n" : "");
  };
}

}  // namespace halflight::app
