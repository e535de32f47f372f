#include "halflight/io/camera_file.h"

#include <optional>

#include <nlohmann/json.hpp>

#include "halflight/base/quantities.h"
#include "halflight/io/read_file.h"

namespace halflight {
namespace {

using Json = nlohmann::json;

constexpr double kDefaultFov = 45.0;  // degrees
constexpr int kLargestSide = 32768;   // pixels

std::optional<Vec3> vector_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 v;
  for (int k = 0; k < 3; ++k) {
    const Json& number = (*found)[static_cast<std::size_t>(k)];
    if (!number.is_number()) return std::nullopt;
    v[k] = number.get<float>();
  }
  return max_component(glm::abs(v)) <= kLongestLength ? std::optional(v) : std::nullopt;
}

int size_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) return 0;
  const auto value = found->get<std::int64_t>();
  return value > 0 && value <= kLargestSide ? static_cast<int>(value) : 0;
}

Result<PlacedCamera> to_camera(const Json& object, const Mat4& to_world, const std::string& where) {
  const auto position = vector_at(object, "position"), target = vector_at(object, "target");
  auto forward = vector_at(object, "forward");
  if (position && target) forward = *target - *position;
  if (!position || !forward || !(glm::length(*forward) > kShortestLength))
    return input_error("the camera has no position or no direction", where,
                       R"(give "position": [x, y, z] and "forward": [x, y, z])");
  const auto fov = object.find("fov_y_deg");
  const double degrees = fov != object.end() && fov->is_number() ? fov->get<double>() : kDefaultFov;
  if (!(degrees > 0.0 && degrees < 180.0))
    return input_error("fov_y_deg must lie between 0 and 180", where);

  PlacedCamera camera;
  camera.position = transform_point(to_world, *position);
  camera.forward = glm::normalize(transform_vector(to_world, *forward));
  if (const auto up = vector_at(object, "up"); up && glm::length(*up) > kShortestLength)
    camera.up = glm::normalize(transform_vector(to_world, *up));
  camera.vertical_fov = static_cast<float>(degrees) * kPi / 180.f;
  return camera;
}

}  // namespace

Result<View> read_camera_file(const std::filesystem::path& path, const Mat4& to_world) {
  const Result<Bytes> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_camera(as_text(*bytes), to_world, path.string());
}

Result<View> parse_camera(std::string_view text, const Mat4& to_world, const std::string& where) {
  const Json file = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!file.is_object())
    return input_error("this is not a camera in JSON", where,
                       R"(write {"position": [x, y, z], "forward": [x, y, z], "fov_y_deg": 45})");
  const auto inner = file.find("camera");
  const Json& object = inner != file.end() && inner->is_object() ? *inner : file;
  Result<PlacedCamera> camera = to_camera(object, to_world, where);
  if (!camera) return tl::unexpected(camera.error());
  View view{std::move(*camera), size_at(object, "width"), size_at(object, "height")};
  if (view.width > 0 && view.height > 0)
    view.camera.aspect = static_cast<float>(view.width) / static_cast<float>(view.height);
  return view;
}

}  // namespace halflight
