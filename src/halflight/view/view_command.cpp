#include "halflight/view/view_command.h"

#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "halflight/view/packet.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr int kLargestSide = 8192;
constexpr float kLargestFactor = 1e4f, kFarthestPlace = 1e7f, kLongestUnit = 1e3f;
constexpr std::size_t kMostGroups = 1024;

// Reads members by name and remembers the first that is wrong, or that nobody knows.
class CommandReader {
 public:
  explicit CommandReader(const json& object) : object_(object) {}

  const json* find(const char* name) {
    known_.insert(name);
    const auto at = object_.find(name);
    return at == object_.end() || at->is_null() ? nullptr : &*at;
  }
  std::optional<bool> flag(const char* name) {
    const json* j = find(name);
    if (!j) return std::nullopt;
    if (!j->is_boolean()) return fail(name, "true or false"), std::nullopt;
    return j->get<bool>();
  }
  std::optional<double> number(const char* name, double least, double most) {
    const json* j = find(name);
    if (!j) return std::nullopt;
    const double value = j->is_number() ? j->get<double>() : std::nan("");
    if (!(value >= least && value <= most))
      return fail(name, fmt::format("a number from {} to {}", least, most)), std::nullopt;
    return value;
  }
  std::optional<Vec3> vector(const char* name, float most) {
    const json* j = find(name);
    if (!j) return std::nullopt;
    const auto v = to_vector(*j, most);
    if (!v) fail(name, "three numbers");
    return v;
  }
  static std::optional<Vec3> to_vector(const json& j, float most) {
    if (!j.is_array() || j.size() != 3) return std::nullopt;
    Vec3 v(0.f);
    for (int i = 0; i < 3; ++i) {
      const json& component = j[static_cast<std::size_t>(i)];
      if (!component.is_number()) return std::nullopt;
      v[i] = component.get<float>();
    }
    if (!is_finite(v) || !(max_component(glm::abs(v)) <= most)) return std::nullopt;
    return v;
  }
  void fail(const std::string& name, const std::string& wanted) {
    if (!error_) error_ = Error{fmt::format("'{}' must be {}", name, wanted), "request", "", {}};
  }
  std::optional<Error> error() {
    for (const auto& [name, value] : object_.items())
      if (!error_ && !known_.contains(name))
        error_ =
            Error{"the request holds a member that is not known", "request", "reload the page", {}};
    return error_;
  }

 private:
  const json& object_;
  std::set<std::string> known_;
  std::optional<Error> error_;
};

Result<json> parse_object(std::string_view text) {
  json parsed = parsed_request(text);
  if (!parsed.is_object())
    return input_error("the request is not a JSON object", "request", "reload the page");
  return parsed;
}

Result<ViewOfInterest> to_view(const json& object) {
  CommandReader read(object);
  ViewOfInterest view;
  view.camera.position = read.vector("position", kFarthestPlace).value_or(Vec3(0.f));
  view.camera.forward = read.vector("forward", kLongestUnit).value_or(Vec3(0.f, 0.f, -1.f));
  view.camera.up = read.vector("up", kLongestUnit).value_or(Vec3(0.f, 1.f, 0.f));
  view.camera.vertical_fov = static_cast<float>(read.number("fov", 0.01, 3.1).value_or(0.8));
  view.width = static_cast<int>(read.number("width", 1, kLargestSide).value_or(640));
  view.height = static_cast<int>(read.number("height", 1, kLargestSide).value_or(360));
  if (auto error = read.error()) return tl::unexpected(*error);
  const float length = glm::length(view.camera.forward);
  const Vec3 side = glm::cross(view.camera.forward, view.camera.up);
  if (!(length > 0.f) || !(glm::length(side) > 1e-6f * length))
    return input_error("'forward' and 'up' do not make a view", "request");
  view.camera.forward /= length;
  return view;
}

void read_groups(CommandReader& read, ViewCommand& command) {
  const json* groups = read.find("groups");
  if (!groups) return;
  if (!groups->is_object() || groups->size() > kMostGroups)
    return read.fail("groups", "an object of names and factors");
  for (const auto& [name, factor] : groups->items()) {
    std::optional<Vec3> rgb = CommandReader::to_vector(factor, kLargestFactor);
    if (factor.is_number()) {
      const float grey = factor.get<float>();
      if (grey <= kLargestFactor) rgb = Rgb(grey);
    }
    if (!rgb || !(min_component(*rgb) >= 0.f))
      return read.fail("groups", "factors from 0 to 10000");
    command.groups.emplace_back(name, *rgb);
  }
}

}  // namespace

Result<ViewOfInterest> parse_view_of_interest(std::string_view text) {
  const Result<json> object = parse_object(text);
  if (!object) return tl::unexpected(object.error());
  return to_view(*object);
}

Result<ViewCommand> parse_view_command(std::string_view text) {
  const Result<json> object = parse_object(text);
  if (!object) return tl::unexpected(object.error());
  CommandReader read(*object);
  ViewCommand command;
  command.paused = read.flag("paused");
  command.give_way = read.flag("giveWay").value_or(false);
  command.step = read.flag("step").value_or(false);
  command.all_important = read.flag("allImportant").value_or(false);
  command.shown = read.flag("shown");
  if (const auto s = read.number("featureSize", 1e-6, 1e6))
    command.feature_size = static_cast<float>(*s);
  if (const auto e = read.number("error", 0.001, 1.0)) command.error = static_cast<float>(*e);
  if (const auto t = read.number("seconds", 0.0, 1e8))
    command.seconds = *t > 0.0 ? *t : std::numeric_limits<double>::infinity();
  if (const auto n = read.number("links", 0.0, 1e9)) command.links = static_cast<std::size_t>(*n);
  if (const auto n = read.number("node", 0.0, 4e9))
    command.node = NodeId(static_cast<std::size_t>(*n));
  command.offset = read.vector("offset", kFarthestPlace);
  if (const json* mode = read.find("visibility")) {
    for (const NamedVisibilityMode& known : kVisibilityModes)
      if (*mode == std::string(known.name)) command.visibility = known.mode;
    if (!command.visibility) read.fail("visibility", "exact, average or multires");
  }
  if (const json* view = read.find("important")) {
    const auto parsed =
        view->is_object() ? to_view(*view) : input_error("'important' must be a view", "request");
    if (!parsed) return tl::unexpected(parsed.error());
    command.important = *parsed;
  }
  read_groups(read, command);
  if (command.give_way && object->size() > 1) read.fail("giveWay", "the only member");
  if (auto error = read.error()) return tl::unexpected(*error);
  if ((command.offset || command.shown) && !command.node.valid())
    return input_error("'node' says what is to be moved or switched", "request");
  return command;
}

}  // namespace halflight
