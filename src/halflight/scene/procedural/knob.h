// One parameter of a built-in scene, as the command line and the documentation see it.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace halflight {

struct Knob {
  std::string name;     // "count"
  std::string meaning;  // with its unit
  std::variant<int*, float*> value;
  double least = 0.0;
  double most = 0.0;
};
using Knobs = std::vector<Knob>;

}  // namespace halflight
