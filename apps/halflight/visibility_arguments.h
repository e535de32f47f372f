// --visibility and --feature-size, and what path tracers make of them.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "halflight/base/result.h"
#include "halflight/rays/world.h"
#include "halflight/visibility/multires_shadows.h"

namespace halflight::app {

struct VisibilityArguments {
  std::optional<VisibilityMode> mode;
  std::string feature_size;  // empty: scene diagonal / 200
};

// `otherwise` is the mode that the help names for when none is given.
void add_visibility_arguments(CLI::App& command, VisibilityArguments& arguments,
                              const std::string& otherwise);

// Metres; negative when none was given.
Result<float> resolve_feature_size(const VisibilityArguments& arguments);

// What a path tracer asks instead of exact shadow rays.
class PathShadows {
 public:
  PathShadows(const World& world, VisibilityMode mode, float feature_size);
  const ShadowTest& test() const { return shadows_; }

 private:
  Visibility visibility_;
  MultiresShadows shadows_;
};
// None when exact shadows are asked for, as they are without --visibility.
Result<std::unique_ptr<const PathShadows>> path_shadows(const VisibilityArguments& arguments,
                                                        const World& world);

}  // namespace halflight::app
