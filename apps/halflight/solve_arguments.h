// The arguments of everything that solves.
#pragma once

#include <memory>
#include <string>

#include <CLI/App.hpp>

#include "halflight/base/progress.h"
#include "halflight/base/result.h"
#include "halflight/solve/solver.h"
#include "visibility_arguments.h"

namespace halflight::app {

struct SolveArguments {
  VisibilityArguments visibility;
  std::string error = "5%";
  std::string time;  // empty: no deadline
  std::string progress = "auto";
  LinkMaker links = LinkMaker::sampled;
  HierarchyKind hierarchy = HierarchyKind::size_grid;
  int threads = 0;
};

void add_solve_arguments(CLI::App& command, SolveArguments& arguments);
Result<SolveOptions> resolve(const SolveArguments& arguments);
Progress::Listener progress_listener(const SolveArguments& arguments);

// Cancels the progress when --time has passed since construction.
class Deadline {
 public:
  Deadline(Progress& progress, const SolveArguments& arguments);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

 private:
  struct Timer;
  std::unique_ptr<Timer> timer_;
};

}  // namespace halflight::app
