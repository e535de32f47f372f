// How the scene readers report a defect among themselves: it is thrown, so that their code reads
// straight through, and load_scene hands it to the caller as an error value.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halflight/base/result.h"

namespace halflight {

struct ReadFailure {
  Error error;
};

[[noreturn]] inline void fail_reading(std::string_view what, std::string_view where,
                                      std::string_view remedy) {
  throw ReadFailure{make_error(Error::Kind::input, what, where, remedy)};
}

template <class T>
T value_or_fail(Result<T> result) {
  if (!result) throw ReadFailure{std::move(result.error())};
  return std::move(*result);
}

// What a reader tolerated. A broken file can be wrong in a million places: the rest is counted.
class ReadWarnings {
 public:
  void add(const std::string& text) {
    if (texts_.size() < kShown)
      texts_.push_back(one_line(text, kLongest));
    else
      ++more_;
  }
  std::vector<std::string> take() {
    if (more_ > 0) texts_.push_back("and " + std::to_string(more_) + " more warnings");
    return std::move(texts_);
  }

 private:
  static constexpr std::size_t kShown = 40, kLongest = 1000;
  std::vector<std::string> texts_;
  std::size_t more_ = 0;
};

}  // namespace halflight
