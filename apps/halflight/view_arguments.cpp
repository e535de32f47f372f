#include "view_arguments.h"

#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "halflight/io/image_write.h"
#include "halflight/output/choose_view.h"

namespace halflight::app {
namespace {

constexpr int kLargestSide = 32768;
constexpr std::int64_t kMostPixelsUnasked = 1 << 26;  // a gigabyte
constexpr float kLargestEv = 60.f;

ToneMap to_tone_map(const std::string& name) {
  static const std::map<std::string, ToneMap> maps = {{"none", ToneMap::none},
                                                      {"filmic", ToneMap::filmic},
                                                      {"agx", ToneMap::agx},
                                                      {"neutral", ToneMap::neutral}};
  const auto found = maps.find(name);
  if (found == maps.end())
    throw CLI::ValidationError("--tone-map",
                               "'" + name + "' is none of none, filmic, agx, neutral");
  return found->second;
}

template <class Number>
std::optional<Number> to_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Result<std::pair<int, int>> to_size(const std::string& text) {
  const std::size_t x = text.find('x');
  const auto width = to_number<int>(std::string_view(text).substr(0, x));
  const auto height =
      x == std::string::npos ? std::nullopt : to_number<int>(std::string_view(text).substr(x + 1));
  const auto fits = [](std::optional<int> n) { return n && *n > 0 && *n <= kLargestSide; };
  if (!fits(width) || !fits(height))
    return input_error("'" + text + "' is not a picture size", "--size", "write it as 1280x720");
  return std::pair(*width, *height);
}

Result<float> to_ev(const std::string& text, const Image& radiance) {
  if (text == "auto") return automatic_ev(radiance);
  const auto ev = to_number<float>(text);
  if (!ev || !(std::abs(*ev) <= kLargestEv))
    return input_error("'" + text + "' is not an exposure", "--exposure",
                       "write auto or a number of stops, as -1.5");
  return *ev;
}

}  // namespace

void add_view_arguments(CLI::App& command, ViewArguments& arguments) {
  command
      .add_option("--camera", arguments.camera,
                  "camera of the scene by name or index, a JSON file, a view "
                  "px,py,pz,tx,ty,tz,fov (position, target, degrees), or auto")
      ->type_name("CAMERA")
      ->capture_default_str();
  command.add_option("--size", arguments.size, "size of the picture in pixels")
      ->type_name("WxH")
      ->default_str("the camera's, or 1280x720");
  command
      .add_option("--exposure", arguments.exposure, "stops by which a PNG is brightened, or auto")
      ->type_name("EV")
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--tone-map",
          [&arguments](const std::string& name) { arguments.tone_map = to_tone_map(name); },
          "how a PNG holds bright light")
      ->type_name("none|filmic|agx|neutral")
      ->default_str("agx");
  command
      .add_option("-o,--output", arguments.output, "picture to write: .png, or .exr for radiance")
      ->check(file_name())
      ->type_name("FILE")
      ->required();
}

Result<void> check(const ViewArguments& arguments) {
  if (!arguments.size.empty())
    if (const auto size = to_size(arguments.size); !size) return tl::unexpected(size.error());
  if (const auto ev = to_ev(arguments.exposure, Image()); !ev) return tl::unexpected(ev.error());
  return check_image_name(arguments.output);
}

void add_files(CommandFiles& files, const ViewArguments& arguments) {
  files.reads_view("the camera", arguments.camera);
  files.writes("-o", arguments.output);
}

Result<View> choose_view(const ViewArguments& arguments, const Scene& scene,
                         const Geometry& geometry, const std::function<PlacedCamera()>& automatic) {
  Result<View> view = choose_view(arguments.camera, scene, geometry, automatic);
  if (!view) return view;
  if (!arguments.size.empty()) {
    const auto size = to_size(arguments.size);
    if (!size) return tl::unexpected(size.error());
    std::tie(view->width, view->height) = *size;
    return view;
  }
  std::tie(view->width, view->height) = picture_size(*view);
  if (std::int64_t{view->width} * view->height > kMostPixelsUnasked)
    return input_error(fmt::format("the camera asks for {} x {} pixels", view->width, view->height),
                       arguments.camera,
                       fmt::format("give --size {0}x{1} if so many are wanted, or fewer",
                                   view->width, view->height));
  return view;
}

Result<void> write_picture(const ViewArguments& arguments, const Image& radiance) {
  if (arguments.output.extension() == ".exr") return write_image(arguments.output, radiance);
  const auto ev = to_ev(arguments.exposure, radiance);
  if (!ev) return tl::unexpected(ev.error());
  return write_image(arguments.output, developed(radiance, *ev, arguments.tone_map));
}

}  // namespace halflight::app
