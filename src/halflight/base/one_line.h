// Text that strangers wrote, made fit to stand in a line of a message.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace halflight {

// The first `most` bytes of UTF-8 or fewer: characters stay whole.
inline std::string_view utf8_prefix(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return text.substr(0, most);
}

// Control characters become spaces: neither new lines nor a terminal's commands get through. What
// is longer than `most` bytes is cut.
inline std::string one_line(std::string_view text, std::size_t most = 300) {
  constexpr std::string_view kCut = "...";
  const bool cut = text.size() > most;
  std::string line(utf8_prefix(text, most));
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(line.begin(), line.end(), is_control, ' ');
  if (cut) line += kCut;
  return line;
}

}  // namespace halflight
