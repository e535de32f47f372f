// The arguments of everything that solves.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "command_files.h"
#include "halflight/base/progress.h"
#include "halflight/base/result.h"
#include "halflight/solve/solver.h"
#include "visibility_arguments.h"

namespace halflight::app {

struct SolveArguments {
  VisibilityArguments visibility;
  std::string error;  // empty: 5 %, not measured
  std::string time;   // empty: no deadline
  std::string progress = "auto";
  std::string memory;              // empty: no limit
  std::vector<std::string> links;  // who makes them, or how many at most
  std::string importance = "none";
  std::filesystem::path feature_sizes;  // rules; empty: none
  HierarchyKind hierarchy = HierarchyKind::size_grid;
  bool intra_cluster = SolveOptions{}.intra_cluster;
  int threads = 0;
};

// Where to stop; the deadline is apart.
struct SolveGoals {
  std::optional<float> error;        // measured relative RMS error of irradiance
  std::optional<std::size_t> links;  // no more than these
};

void add_solve_arguments(CLI::App& command, SolveArguments& arguments);
struct SolvePlan {
  SolveOptions options;
  SolveGoals goals;
};
// Rules, and views that are files.
void add_files(CommandFiles& files, const SolveArguments& arguments);
Result<SolvePlan> resolve(const SolveArguments& arguments);
// Adds what needs the scene: views and rules.
Result<void> complete(SolvePlan& plan, const SolveArguments& arguments, const World& world);
Progress::Listener progress_listener(const SolveArguments& arguments);

// Cancels the progress when --time has passed since a start.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;
  Deadline(Progress& progress, const SolveArguments& arguments, Clock::time_point start);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  bool set() const { return timer_ != nullptr; }
  double seconds_left() const;  // when set

 private:
  struct Timer;
  std::unique_ptr<Timer> timer_;
};

}  // namespace halflight::app
