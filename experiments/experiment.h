// An experiment reproduces one figure or table of the paper and hands over a section of the report.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "halflight/base/image.h"
#include "halflight/base/progress.h"
#include "halflight/base/result.h"

namespace halflight::experiments {

struct Picture {
  std::string file;  // its name in the output folder, without the ending
  Image image;       // shown as it is: linear, 1 is white
  std::string caption;
};
struct PictureRow {
  std::string title;
  std::vector<Picture> pictures;  // side by side
};
struct Table {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  // the first cell names the row
};
using Block = std::variant<std::string, PictureRow, Table>;  // a string is a paragraph

struct Section {
  std::string name;  // of the experiment
  std::string title;
  std::vector<Block> blocks;
  nlohmann::ordered_json numbers;  // what it measured, for programs
};

struct Experiment {
  std::string_view name;   // on the command line: "table1"
  std::string_view shows;  // one line
  Result<Section> (*run)(const Progress& progress);
};

// In the order of the paper. To add one: its file defines the function, registry.cpp lists it.
std::span<const Experiment> all_experiments();

}  // namespace halflight::experiments
