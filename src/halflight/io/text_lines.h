// Line-based text formats: lines with their numbers, and the words and numbers of a line.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace halflight {

// The words of one line, taken from the left.
class LineWords {
 public:
  explicit LineWords(std::string_view line)
      : rest_(line.substr(0, line.find_last_not_of(kSpaces) + 1)) {
    skip_spaces();
  }

  bool empty() const { return rest_.empty(); }
  // Everything that is left, without the spaces around it.
  std::string_view rest() const { return rest_; }
  // The next word; empty at the end of the line.
  std::string_view word() {
    const std::size_t length = std::min(rest_.find_first_of(kSpaces), rest_.size());
    const std::string_view w = rest_.substr(0, length);
    rest_.remove_prefix(length);
    skip_spaces();
    return w;
  }

 private:
  static constexpr std::string_view kSpaces = " \t\v\f";
  void skip_spaces() {
    const std::size_t first = std::min(rest_.find_first_not_of(kSpaces), rest_.size());
    rest_.remove_prefix(first);
  }
  std::string_view rest_;
};

// The whole word as a number, in any locale; nothing when it is not one, or is not finite as float.
inline std::optional<float> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  const float number = static_cast<float>(value);
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

inline std::optional<std::int64_t> to_integer(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// Lines that end with LF, CRLF or CR; a backslash before the end joins the next line on. The text
// is written to (a joint becomes spaces) and must outlive the lines.
class TextLines {
 public:
  explicit TextLines(std::vector<std::uint8_t>& text)
      : at_(reinterpret_cast<char*>(text.data())), end_(at_ + text.size()) {
    if (std::string_view(at_, text.size()).starts_with("\xef\xbb\xbf")) at_ += 3;
  }

  // False at the end of the text.
  bool next(std::string_view& line) {
    if (at_ == end_) return false;
    number_ += joined_ + 1;
    joined_ = 0;
    char* const first = at_;
    for (;;) {
      while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
      char* const last = at_;
      if (at_ != end_) at_ += at_[0] == '\r' && at_ + 1 != end_ && at_[1] == '\n' ? 2 : 1;
      const bool joins = last != first && last[-1] == '\\';
      if (joins) std::fill(last - 1, at_, ' ');
      if (!joins || at_ == end_) {
        line = std::string_view(first, static_cast<std::size_t>(last - first));
        return true;
      }
      ++joined_;
    }
  }
  // Of the line returned last, counted from 1: where it starts.
  std::size_t number() const { return number_; }

 private:
  char* at_;
  char* end_;
  std::size_t number_ = 0;
  std::size_t joined_ = 0;
};

}  // namespace halflight
