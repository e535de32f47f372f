// The report as one self-contained HTML file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "experiments/experiment.h"
#include "halflight/base/result.h"

namespace halflight::experiments {

// Pictures are read from FILE.png in `folder` and embedded.
Result<std::string> html_page(const std::filesystem::path& folder,
                              std::span<const Section> sections);

std::string escape_html(std::string_view text);
std::string base64(std::span<const std::uint8_t> bytes);  // RFC 4648, padded

}  // namespace halflight::experiments
