// --visibility and --feature-size, and what path tracers make of them.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "halflight/base/result.h"
#include "halflight/rays/world.h"
#include "halflight/visibility/multires_paths.h"

namespace halflight::app {

struct VisibilityArguments {
  std::optional<VisibilityMode> mode;
  std::string feature_size;                // empty: scene diagonal / 200
  BounceRays bounces = BounceRays::exact;  // of path tracers
};

// `otherwise` is the mode that the help names for when none is given.
void add_visibility_arguments(CLI::App& command, VisibilityArguments& arguments,
                              const std::string& otherwise);

// For those who trace paths.
void add_bounce_argument(CLI::App& command, VisibilityArguments& arguments);

// Metres; negative when none was given, or one in pixels.
Result<float> resolve_feature_size(const VisibilityArguments& arguments);

// "12px@CAMERA": pixels of a view.
struct PixelSizeWish {
  float pixels = 0.f;
  std::string camera;
};
Result<std::optional<PixelSizeWish>> pixel_size_wish(const std::string& feature_size);

// Complains about what can be known to be wrong for path tracers before any work is done: also
// feature sizes in pixels, where they would matter.
Result<void> check_for_paths(const VisibilityArguments& arguments);
// Tells of options that only matter with --visibility.
void warn_of_idle_visibility(const CLI::App& command, const VisibilityArguments& arguments);

// What a path tracer asks instead of exact rays.
class PathVisibility {
 public:
  PathVisibility(const World& world, VisibilityMode mode, float feature_size, BounceRays bounces);
  const PathRays& rays() const { return rays_; }

 private:
  Visibility visibility_;
  MultiresPaths rays_;
};
// None when exact rays are asked for, as they are without --visibility.
Result<std::unique_ptr<const PathVisibility>> path_visibility(const VisibilityArguments& arguments,
                                                              const World& world);

}  // namespace halflight::app
