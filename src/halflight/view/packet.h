// Binary answers of the live view: "HLP1", the length of a JSON header, the header, then arrays at
// the offsets that it names; everything little-endian and on multiples of four bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include <nlohmann/json.hpp>

namespace halflight {

class Packet {
 public:
  nlohmann::json header = nlohmann::json::object();

  // Elements of 4-byte components: float and std::uint32_t, or structs of nothing else.
  template <class T>
  void add(const char* name, const char* type, std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
    header["arrays"][name] = {
        {"type", type}, {"offset", data_.size()}, {"count", items.size_bytes() / 4}};
    data_.append(reinterpret_cast<const char*>(items.data()), items.size_bytes());
  }
  std::string bytes() const;

 private:
  std::string data_;
};

// What a page has sent; discarded where it is no JSON, or nested deeper than any request is: to
// copy or to write such a value takes the stack.
nlohmann::json parsed_request(std::string_view text);

// Text of scene files may be anything; what is no UTF-8 is replaced.
std::string json_text(const nlohmann::json& json);

}  // namespace halflight
