// The sub-commands: each adds itself to the command line and, when chosen, runs.
#pragma once

#include <string>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "halflight/base/result.h"

namespace halflight::app {

// Exit statuses of the contract.
enum ExitStatus {
  kGoalMet = 0,
  kBadInput = 1,
  kSystemFailure = 2,
  kInterrupted = 3,
  kBudgetEnded = 4,
};

// Prints the error's one line to stderr and returns its exit status.
int fail(const Error& error);
// Prints a warning of one line to stderr.
void warn(const std::string& text);
// Of outputs that are written one after another: what cannot be written keeps nothing else from
// being written. The first failure stays in `written`, others are warned of.
void also(Result<void>& written, const Result<void>& next);

// Each registers a sub-command; its callback stores the exit status in `status`.
void add_inspect(CLI::App& cli, int& status);
void add_reference(CLI::App& cli, int& status);
void add_render(CLI::App& cli, int& status);
void add_mix(CLI::App& cli, int& status);
void add_sample(CLI::App& cli, int& status);
void add_solve(CLI::App& cli, int& status);
void add_scene(CLI::App& cli, int& status);
void add_compare(CLI::App& cli, int& status);
void add_view(CLI::App& cli, int& status);
void add_reproduce(CLI::App& cli, int& status);

}  // namespace halflight::app
