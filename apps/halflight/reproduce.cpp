// halflight reproduce: the paper's figures and tables as pictures, numbers and a report page.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command_files.h"
#include "commands.h"
#include "experiments/experiment.h"
#include "experiments/report.h"
#include "halflight/io/atomic_file.h"

namespace halflight::app {
namespace {

using experiments::Experiment;

struct Arguments {
  std::vector<std::string> names;  // empty: all
  std::filesystem::path folder;
};

Result<std::vector<Experiment>> chosen(const std::vector<std::string>& names) {
  const auto all = experiments::all_experiments();
  if (names.empty()) return std::vector<Experiment>(all.begin(), all.end());
  std::vector<Experiment> list;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Experiment& e) { return e.name == name; });
    if (found == all.end()) {
      std::string known;
      for (const Experiment& e : all) known += (known.empty() ? "" : ", ") + std::string(e.name);
      return input_error("there is no experiment '" + name + "'", {}, "known: " + known);
    }
    list.push_back(*found);
  }
  return list;
}

// The folder is made now: it is a matter of minutes until it is needed.
Result<void> check_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure || !std::filesystem::is_directory(folder, failure))
    return system_error(
        "the folder cannot be made" + (failure ? ": " + failure.message() : std::string()),
        folder.string(), "name another folder");
  for (const char* name : {"report.html", "report.md", "numbers.json"})
    if (auto ok = check_writable(folder / name); !ok) return ok;
  return {};
}

Result<void> reproduce(const Arguments& arguments) {
  const auto list = chosen(arguments.names);
  if (!list) return tl::unexpected(list.error());
  if (auto ok = check_folder(arguments.folder); !ok) return ok;
  const Progress progress;
  std::vector<experiments::Section> sections;
  for (const Experiment& experiment : *list) {
    fmt::print(stderr, "{}: {}\n", experiment.name, experiment.shows);
    auto section = experiment.run(progress);
    if (!section) return tl::unexpected(section.error());
    sections.push_back(std::move(*section));
  }
  if (auto written = experiments::write_report(arguments.folder, sections); !written)
    return written;
  fmt::print("{}\n", (arguments.folder / "report.html").string());
  return {};
}

}  // namespace

void add_reproduce(CLI::App& cli, int& status) {
  auto* command = cli.add_subcommand("reproduce", "Write the paper's figures and tables");
  const auto arguments = std::make_shared<Arguments>();
  std::string known;
  for (const Experiment& e : experiments::all_experiments())
    known += fmt::format("\n  {:10} {}", e.name, e.shows);
  command->add_option("experiment", arguments->names, "Which ones; default: all");
  command
      ->add_option("-o,--output", arguments->folder,
                   "Folder for report.html, report.md and pictures")
      ->check(file_name())
      ->required();
  command->footer("Experiments:" + known);
  command->callback([arguments, &status] {
    const Result<void> done = reproduce(*arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
