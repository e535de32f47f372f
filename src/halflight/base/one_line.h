// Text that strangers wrote, made fit to stand in a line of a message.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace halflight {

// Control characters become spaces: neither new lines nor a terminal's commands get through. What
// is longer than `most` bytes is cut, between characters of UTF-8.
inline std::string one_line(std::string_view text, std::size_t most = 300) {
  constexpr std::string_view kCut = "...";
  const bool cut = text.size() > most;
  if (cut) {
    std::size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    text = text.substr(0, end);
  }
  std::string line(text);
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(line.begin(), line.end(), is_control, ' ');
  if (cut) line += kCut;
  return line;
}

}  // namespace halflight
