// The report: pictures, numbers and two pages about the same sections.
#pragma once

#include <filesystem>
#include <span>

#include "experiments/experiment.h"

namespace halflight::experiments {

// Writes into `folder` (made when missing): FILE.png for every picture, report.html (one
// self-contained file), report.md (refers to the pictures) and numbers.json.
Result<void> write_report(const std::filesystem::path& folder, std::span<const Section> sections);

}  // namespace halflight::experiments
