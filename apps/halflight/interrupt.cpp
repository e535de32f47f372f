#include "interrupt.h"

#include <atomic>
#include <csignal>

namespace halflight::app {
namespace {

std::atomic<Progress*> g_progress{nullptr};  // signal handlers reach nothing else
std::atomic<bool> g_interrupted{false};

void on_signal(int signal) {
  std::signal(signal, SIG_DFL);
  g_interrupted.store(true);
  if (Progress* progress = g_progress.load()) progress->cancel();
}

}  // namespace

Interruptible::Interruptible(Progress& progress) {
  g_interrupted.store(false);
  g_progress.store(&progress);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

Interruptible::~Interruptible() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  g_progress.store(nullptr);
}

bool Interruptible::interrupted() const { return g_interrupted.load(); }

}  // namespace halflight::app
