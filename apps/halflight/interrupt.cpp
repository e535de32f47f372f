#include "interrupt.h"

#include <atomic>
#include <csignal>

namespace halflight::app {
namespace {

std::atomic<Progress*> g_progress{nullptr};  // signal handlers reach nothing else
std::atomic<bool> g_interrupted{false};

// What the program was told to ignore stays ignored: SIGINT in the background of a script.
void handle_signals_by(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

void on_signal(int signal) {
  handle_signals_by(SIG_DFL);
  if (g_interrupted.exchange(true)) std::raise(signal);  // a second one at the same time
  if (Progress* progress = g_progress.load()) progress->cancel();
}

}  // namespace

Interruptible::Interruptible(Progress& progress) {
  g_interrupted.store(false);
  g_progress.store(&progress);
  handle_signals_by(on_signal);
}

Interruptible::~Interruptible() {
  handle_signals_by(SIG_DFL);
  g_progress.store(nullptr);
}

bool Interruptible::interrupted() const { return g_interrupted.load(); }

}  // namespace halflight::app
