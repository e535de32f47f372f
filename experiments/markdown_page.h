// The report as Markdown; pictures are files beside it.
#pragma once

#include <span>
#include <string>

#include "experiments/experiment.h"

namespace halflight::experiments {

std::string markdown_page(std::span<const Section> sections);

}  // namespace halflight::experiments
