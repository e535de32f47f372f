// Errors at the border are values: one clear line that says what, where and what to do.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

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

inline tl::unexpected<Error> input_error(std::string what, std::string where = {},
                                         std::string remedy = {}) {
  return tl::unexpected<Error>(
      Error{std::move(what), std::move(where), std::move(remedy), Error::Kind::input});
}
inline tl::unexpected<Error> system_error(std::string what, std::string where = {},
                                          std::string remedy = {}) {
  return tl::unexpected<Error>(
      Error{std::move(what), std::move(where), std::move(remedy), Error::Kind::system});
}

}  // namespace halflight
