// Errors at the border are values: one clear line that says what, where and what to do.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "halflight/base/one_line.h"

namespace halflight {

struct Error {
  enum class Kind {
    input,   // bad usage or input: exit status 1
    system,  // system or resource failure: exit status 2
  };
  std::string what;    // "material 'wall' refers to texture 7, but there are only 3"
  std::string where;   // file, and line or JSON path where known
  std::string remedy;  // "export the scene again with its textures"; may be empty
  Kind kind = Kind::input;

  std::string line() const {
    return (where.empty() ? "" : where + ": ") + what + (remedy.empty() ? "" : " (" + remedy + ")");
  }
};

template <class T>
using Result = tl::expected<T, Error>;

// Names that strangers chose stand in messages: all three parts become one line each.
inline Error make_error(Error::Kind kind, std::string_view what, std::string_view where,
                        std::string_view remedy) {
  constexpr std::size_t kLongestPlace = 1000;
  return {one_line(what), one_line(where, kLongestPlace), one_line(remedy), kind};
}
inline tl::unexpected<Error> input_error(std::string_view what, std::string_view where = {},
                                         std::string_view remedy = {}) {
  return tl::unexpected<Error>(make_error(Error::Kind::input, what, where, remedy));
}
inline tl::unexpected<Error> system_error(std::string_view what, std::string_view where = {},
                                          std::string_view remedy = {}) {
  return tl::unexpected<Error>(make_error(Error::Kind::system, what, where, remedy));
}

}  // namespace halflight
