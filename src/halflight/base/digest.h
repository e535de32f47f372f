// A fingerprint of bytes, 64 bits: tells what was changed by accident, not what was forged.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "halflight/base/hash.h"

namespace halflight {

class Digest {
 public:
  // The length counts as well, so that where one array ends and the next begins matters.
  void add_bytes(std::span<const std::byte> bytes) {
    std::size_t i = 0;
    for (; i + sizeof(std::uint64_t) <= bytes.size(); i += sizeof(std::uint64_t))
      add_word(&bytes[i], sizeof(std::uint64_t));
    if (i < bytes.size()) add_word(&bytes[i], bytes.size() - i);
    value_ = mix_bits(value_ ^ bytes.size());
  }
  void add(std::string_view text) { add_bytes(std::as_bytes(std::span(text))); }
  // Types without padding, whose bytes say all.
  template <class T>
  void add(std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(std::as_bytes(items));
  }
  template <class T>
  void add(const T& value) {
    add(std::span<const T>(&value, 1));
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_word(const std::byte* at, std::size_t n) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, n);
    value_ = mix_bits(value_ ^ word);
  }
  std::uint64_t value_ = 0;
};

}  // namespace halflight
