#include "halflight/view/packet.h"

namespace halflight {

nlohmann::json parsed_request(std::string_view text) {
  using nlohmann::json;
  constexpr int kDeepest = 16;
  bool deep = false;
  json request = json::parse(
      text,
      [&](int depth, json::parse_event_t, json&) {
        deep = deep || depth > kDeepest;
        return !deep;
      },
      false);
  return deep ? json(json::value_t::discarded) : request;
}

std::string json_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string Packet::bytes() const {
  std::string text = json_text(header);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string all("HLP1");
  all.reserve(8 + text.size() + data_.size());
  all.append(reinterpret_cast<const char*>(&length), sizeof length);
  return all.append(text).append(data_);
}

}  // namespace halflight
