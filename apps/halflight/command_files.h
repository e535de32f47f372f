// The files that a command reads and writes: none that it writes may be one that it reads, or be
// written twice.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "halflight/base/result.h"

namespace halflight::app {

struct NamedFile {
  std::string role;  // "the scene", "--report"
  std::filesystem::path path;
};

struct CommandFiles {
  std::vector<NamedFile> inputs, outputs;

  // An empty path is no file.
  void reads(std::string role, const std::filesystem::path& path);
  void writes(std::string role, const std::filesystem::path& path);
  // A view reads a file when it names one.
  void reads_view(std::string role, const std::string& view);
  // A scene, and what it refers to.
  void reads_scene(const std::filesystem::path& path);
};

// Before any work: an error when an output would replace an input or another output, by whatever
// names or links they are called, or when one cannot be written. Devices, pipes and the like may be
// named several times.
Result<void> check(const CommandFiles& files);

// For options that name a file: '' names none.
CLI::Validator file_name();

}  // namespace halflight::app
