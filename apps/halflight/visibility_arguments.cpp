#include "visibility_arguments.h"

#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "halflight/base/quantities.h"
#include "halflight/hierarchy/surfaces.h"
#include "halflight/visibility/multires_build.h"
#include "idle_options.h"

namespace halflight::app {
namespace {

Visibility make_visibility(const World& world, VisibilityMode mode) {
  const Surfaces surfaces = build_surfaces(world.geometry);
  return Visibility(world, surfaces, one_cluster(surfaces), mode);
}

}  // namespace

void add_visibility_arguments(CLI::App& command, VisibilityArguments& arguments,
                              const std::string& otherwise) {
  command
      .add_option(
          "--feature-size", arguments.feature_size,
          "smallest shadow kept exact, e.g. 5cm, or 12px@CAMERA when solving; 0: all [scene "
          "diagonal / 200]")
      ->type_name("LEN");
  std::map<std::string, VisibilityMode> modes;
  for (const NamedVisibilityMode& m : kVisibilityModes) modes.emplace(m.name, m.mode);
  command
      .add_option("--visibility", arguments.mode,
                  "exact: every surface; average: clusters as media; multires: as media only where "
                  "no shadow of the feature size is lost")
      ->transform(CLI::CheckedTransformer(modes).description(""))
      ->type_name("exact|average|multires")
      ->default_str(otherwise);
}

void add_bounce_argument(CLI::App& command, VisibilityArguments& arguments) {
  const std::map<std::string, BounceRays> rays{{"exact", BounceRays::exact},
                                               {"clusters", BounceRays::clusters}};
  command
      .add_option("--bounces", arguments.bounces,
                  "with --visibility: exact, or paths that go on from clusters up to the feature "
                  "size as well")
      ->transform(CLI::CheckedTransformer(rays).description(""))
      ->type_name("exact|clusters")
      ->default_str("exact");
}

Result<std::optional<PixelSizeWish>> pixel_size_wish(const std::string& feature_size) {
  const std::size_t unit = feature_size.find("px@");
  if (unit == std::string::npos) return std::optional<PixelSizeWish>();
  PixelSizeWish wish;
  const char* end = feature_size.data() + unit;
  const auto [stop, error] = std::from_chars(feature_size.data(), end, wish.pixels);
  wish.camera = feature_size.substr(unit + 3);
  if (error != std::errc() || stop != end || !(wish.pixels > 0.f) || !std::isfinite(wish.pixels) ||
      wish.camera.empty())
    return input_error(fmt::format("--feature-size '{}' is not a number of pixels", feature_size),
                       {}, "write it like 12px@CAMERA");
  return wish;
}

Result<float> resolve_feature_size(const VisibilityArguments& arguments) {
  if (arguments.feature_size.empty()) return -1.f;
  const Result<std::optional<PixelSizeWish>> wish = pixel_size_wish(arguments.feature_size);
  if (!wish) return tl::unexpected(wish.error());
  if (*wish) return -1.f;
  const Result<double> length = parse_length(arguments.feature_size);
  if (!length) return tl::unexpected(length.error());
  if (*length > kLongestLength || (*length > 0.0 && *length < kShortestLength))
    return input_error(fmt::format("--feature-size '{}' is not a length from {:g} m to {:g} m",
                                   arguments.feature_size, kShortestLength, kLongestLength),
                       {}, "write it like 5cm; 0 keeps all shadows exact");
  return static_cast<float>(*length);
}

Result<void> check_for_paths(const VisibilityArguments& arguments) {
  if (const auto size = resolve_feature_size(arguments); !size) return tl::unexpected(size.error());
  if (arguments.mode.value_or(VisibilityMode::exact) == VisibilityMode::exact) return {};
  const auto pixels = pixel_size_wish(arguments.feature_size);
  if (!pixels) return tl::unexpected(pixels.error());
  if (!*pixels) return {};
  return input_error(fmt::format("--feature-size '{}': paths have the same everywhere, not so many "
                                 "pixels",
                                 arguments.feature_size),
                     {}, "give a length, like 5cm");
}

void warn_of_idle_visibility(const CLI::App& command, const VisibilityArguments& arguments) {
  if (!arguments.mode)
    warn_of_idle(command, {"--feature-size", "--bounces"}, "on paths without --visibility");
}

PathVisibility::PathVisibility(const World& world, VisibilityMode mode, float feature_size,
                               BounceRays bounces)
    : visibility_(make_visibility(world, mode)), rays_(visibility_, feature_size, bounces) {}

Result<std::unique_ptr<const PathVisibility>> path_visibility(const VisibilityArguments& arguments,
                                                              const World& world) {
  Result<float> size = resolve_feature_size(arguments);
  if (!size) return tl::unexpected(size.error());
  if (*size < 0.f) size = world.geometry.bounds.diagonal() / 200.f;
  const VisibilityMode mode = arguments.mode.value_or(VisibilityMode::exact);
  if (mode == VisibilityMode::exact || !(*size > 0.f)) return nullptr;
  return std::make_unique<const PathVisibility>(world, mode, *size, arguments.bounces);
}

}  // namespace halflight::app
