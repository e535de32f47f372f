// Progress out, cancellation in: one object, watched from outside the solver.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace halflight {

class Progress {
 public:
  // share is in [0, 1] of the named phase. Called from the thread that runs the phase.
  using Listener = std::function<void(std::string_view phase, double share)>;

  Progress() = default;
  explicit Progress(Listener listener) : listener_(std::move(listener)) {}

  void report(std::string_view phase, double share) const {
    if (listener_) listener_(phase, share);
  }
  // Safe from signal handlers and other threads.
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  Listener listener_;
  std::atomic<bool> cancelled_{false};
};

}  // namespace halflight
