// What the page asks the live view to do, as JSON, checked before anybody acts on it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/solve/solver.h"

namespace halflight {

struct ViewCommand {
  std::optional<bool> paused;
  bool give_way = false;              // alone: for a moment the page needs the processor
  bool step = false;                  // one iteration, though paused
  std::optional<float> feature_size;  // metres
  std::optional<float> error;
  std::optional<VisibilityMode> visibility;
  std::optional<double> seconds;     // of solving; infinite: no limit
  std::optional<std::size_t> links;  // 0: no limit
  std::optional<ViewOfInterest> important;
  bool all_important = false;
  std::vector<std::pair<std::string, Rgb>> groups;  // factors of light groups
  NodeId node;                                      // to be moved or switched
  std::optional<Vec3> offset;                       // metres from where the file has it
  std::optional<bool> shown;
};

// {"paused": true, "featureSize": 0.05, "groups": {"Lamp": 0.5}, "node": 3, "offset": [0, 1, 0]}
Result<ViewCommand> parse_view_command(std::string_view text);

// {"position": [..], "forward": [..], "up": [..], "fov": radians, "width": w, "height": h}
Result<ViewOfInterest> parse_view_of_interest(std::string_view text);

}  // namespace halflight
