// Table 1: the FBEM of four coarse solutions at five feature sizes.
#pragma once

#include <array>

#include "experiments/cube_wall.h"

namespace halflight::experiments {

inline constexpr std::array kTableSizes{5.0, 16.0, 24.0, 30.0, 40.0};  // feature sizes, pixels

// value[row of kTableSizes][group - 1]
using FbemTable = std::array<std::array<double, kGroups>, kTableSizes.size()>;

inline constexpr FbemTable kPaperTable{{{14.76, 16.34, 17.25, 17.31},
                                        {9.37, 12.24, 15.76, 15.80},
                                        {4.78, 6.50, 9.06, 14.74},
                                        {4.23, 3.16, 6.90, 13.37},
                                        {3.65, 2.33, 3.35, 6.94}}};

struct TableResult {
  FbemTable fbem{};       // the paper's metric
  FbemTable averages{};   // its part outside the mask, where only averages are asked for
  FbemTable symmetric{};  // lit features count as well
  std::array<double, kGroups> l2{};
};
TableResult measure_table(int seed, int cell);

// The one factor on all our values that brings them closest to the paper's (the paper does not give
// its grey scale), and what is left: root mean square of ln(scale x ours / paper).
struct ScaleFit {
  double scale = 1;
  double rms_log_deviation = 0;
};
ScaleFit fit_to_paper(const FbemTable& ours);

}  // namespace halflight::experiments
