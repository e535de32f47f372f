// What `halflight compare` prints and writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "halflight/base/image.h"
#include "halflight/base/result.h"
#include "halflight/features/compare.h"

namespace halflight::app {

struct CompareInput {
  std::filesystem::path reference, test;
  std::filesystem::path visibility_mask;  // empty: estimated
};

// Empty names are not written. Where there are several feature sizes, "-SIZE" goes before the
// ending.
struct CompareFiles {
  std::filesystem::path mask, difference, false_colour;
  bool any() const { return !mask.empty() || !difference.empty() || !false_colour.empty(); }
};
// The names that are written for one of these, each once.
std::vector<std::filesystem::path> names_for(const std::filesystem::path& path,
                                             const std::vector<double>& feature_sizes);
Result<void> write_pictures(const CompareFiles& files, const Image& reference, const Image& test,
                            const Comparison& result);

std::string json_of(const CompareInput& input, const Image& reference,
                    const CompareOptions& options, const Comparison& result);
std::string text_of(const CompareOptions& options, const Comparison& result);

}  // namespace halflight::app
