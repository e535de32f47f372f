#include "halflight/output/choose_view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace halflight {
namespace {

constexpr float kDefaultFov = 45.f;  // degrees
// Pixels of pictures of views that ask for no size.
constexpr int kUsualWidth = 1280, kUsualHeight = 720, kGreatestHeight = 4 * kUsualWidth;

template <class Number>
std::optional<Number> whole_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// All parts between commas as finite numbers, or nothing.
std::optional<std::vector<float>> number_list(std::string_view text) {
  std::vector<float> values;
  for (;;) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto value = whole_number<float>(text.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values.push_back(*value);
    if (comma == text.size()) return values;
    text.remove_prefix(comma + 1);
  }
}

Result<View> given_view(const std::vector<float>& v, const Mat4& to_world) {
  if (v.size() != 6 && v.size() != 7)
    return input_error(
        fmt::format("a view has 6 or 7 numbers, not {}", v.size()), "--camera",
        "px,py,pz,tx,ty,tz,fov: position, target, vertical field of view in degrees");
  View view;
  const Vec3 target = transform_point(to_world, {v[3], v[4], v[5]});
  view.camera.position = transform_point(to_world, {v[0], v[1], v[2]});
  if (!(glm::distance(target, view.camera.position) > 0.f))
    return input_error("position and target of the view are the same point", "--camera");
  view.camera.forward = glm::normalize(target - view.camera.position);
  const float degrees = v.size() == 7 ? v[6] : kDefaultFov;
  if (!(degrees > 0.f && degrees < 180.f))
    return input_error("the field of view must lie between 0 and 180 degrees", "--camera");
  view.camera.vertical_fov = degrees * kPi / 180.f;
  return view;
}

std::string known_cameras(const Geometry& geometry) {
  if (geometry.cameras.empty()) return "the scene has no camera: use auto, a view or a JSON file";
  std::string names;
  for (std::size_t i = 0; i < geometry.cameras.size(); ++i)
    names += fmt::format("{}{} '{}'", i ? ", " : "the scene has ", i, geometry.cameras[i].name);
  return names;
}

Result<View> wished_view(const std::string& wish, const Scene& scene, const Geometry& geometry,
                         const std::function<PlacedCamera()>& automatic) {
  const auto& cameras = geometry.cameras;
  if (wish == "auto") {
    const auto first = std::ranges::find_if(cameras, can_look);
    return View{first != cameras.end() ? *first : automatic()};
  }
  const auto named = std::ranges::find(cameras, wish, &PlacedCamera::name);
  if (named != cameras.end()) return View{*named};
  if (const auto index = whole_number<std::size_t>(wish); index && *index < cameras.size())
    return View{cameras[*index]};
  if (wish.ends_with(".json")) return read_camera_file(wish, scene.to_world);
  if (const auto numbers = number_list(wish); numbers && numbers->size() > 1)
    return given_view(*numbers, scene.to_world);
  return input_error(fmt::format("there is no camera '{}'", wish), "--camera",
                     known_cameras(geometry));
}

}  // namespace

Result<View> choose_view(const std::string& wish, const Scene& scene, const Geometry& geometry,
                         const std::function<PlacedCamera()>& automatic) {
  Result<View> view = wished_view(wish, scene, geometry, automatic);
  if (view && !can_look(view->camera))
    return input_error(fmt::format("the camera '{}' has no direction or no usable place", wish),
                       "--camera", "give its node a scale of 1, or another view");
  return view;
}

std::pair<int, int> picture_size(const View& view) {
  if (view.width > 0 && view.height > 0) return {view.width, view.height};
  if (!(view.camera.aspect > 0.f)) return {kUsualWidth, kUsualHeight};
  const float height = std::round(static_cast<float>(kUsualWidth) / view.camera.aspect);
  return {kUsualWidth, static_cast<int>(std::clamp(height, 1.f, float{kGreatestHeight}))};
}

}  // namespace halflight
