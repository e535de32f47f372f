#include "json_mutator.h"

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <nlohmann/json.hpp>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace halflight::fuzz {
namespace {

using Json = nlohmann::ordered_json;
using Random = std::minstd_rand;

constexpr std::size_t kDeepest = 200;

std::size_t below(Random& random, std::size_t n) { return random() % n; }

// All values, containers before what they hold; not those too deep to be copied and written.
std::vector<Json*> values_of(Json& root) {
  std::vector<std::pair<Json*, std::size_t>> found{{&root, 0}};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto [value, depth] = found[i];
    if (depth > kDeepest) return {};
    if (value->is_structured())
      for (Json& child : *value) found.emplace_back(&child, depth + 1);
  }
  std::vector<Json*> values;
  for (const auto& entry : found) values.push_back(entry.first);
  return values;
}

Json odd_value(Random& random) {
  static const std::array<Json, 24> kValues{0,
                                            1,
                                            -1,
                                            2,
                                            3,
                                            255,
                                            65535,
                                            65536,
                                            4294967295U,
                                            1e-40,
                                            1e-30,
                                            1e30,
                                            3.4e38,
                                            -3.4e38,
                                            1e300,
                                            0.5,
                                            9007199254740993U,
                                            nullptr,
                                            true,
                                            false,
                                            "",
                                            "data:,",
                                            Json::array(),
                                            Json::object()};
  return kValues[below(random, kValues.size())];
}

void mutate_string(Json& value, Random& random) {
  auto text = value.get<std::string>();
  const std::size_t size = text.size();
  text.resize(size + 16);
  text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), size, text.size()));
  value = below(random, 8) == 0 ? std::string() : text;
}

void change(Json& value, const std::vector<Json*>& all, Random& random) {
  const Json other = *all[below(random, all.size())];
  switch (below(random, 6)) {
    case 0:
      value = other;
      return;
    case 1:
      value = odd_value(random);
      return;
    case 2:
      if (!value.is_structured() || value.empty()) break;
      if (value.is_array())
        value.erase(below(random, value.size()));
      else
        value.erase(std::next(value.begin(), static_cast<int>(below(random, value.size()))));
      return;
    case 3:
      if (value.is_array()) return value.push_back(other);
      break;
    case 4:
      if (value.is_string()) return mutate_string(value, random);
      break;
    default:
      break;
  }
  if (value.is_number())
    value = value.get<double>() +
            (below(random, 2) == 0 ? 1.0 : -1.0) * static_cast<double>(1 + below(random, 4));
  else
    value = odd_value(random);
}

}  // namespace

std::string mutated_json(const std::string& text, unsigned seed, std::size_t most) {
  Json root = Json::parse(text, nullptr, false);
  if (root.is_discarded()) return {};
  Random random(seed + 1);
  for (std::size_t left = 1 + below(random, 3); left > 0; --left) {
    const std::vector<Json*> values = values_of(root);
    if (values.empty()) return {};
    change(*values[below(random, values.size())], values, random);
  }
  if (values_of(root).empty()) return {};
  std::string changed = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  return changed.size() <= most ? changed : std::string();
}

}  // namespace halflight::fuzz
