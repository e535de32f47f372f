// Error of averaging the visibility of a point light over a patch (paper appendix A.2).
#pragma once

#include <cmath>

namespace halflight {

// Norms, per area, of v - mean(v) for a binary v whose mean is `mean_visibility` in [0, 1]:
// equations (5) and (10). They depend on the mean alone, not on the size or shape of the shadows;
// that is why plain norms cannot tell feature sizes apart. Not valid for fractional v: a half
// shadow everywhere has no error.
inline double averaging_error_l1(double mean_visibility) {
  return 2 * mean_visibility * (1 - mean_visibility);
}
inline double averaging_error_l2(double mean_visibility) {
  return std::sqrt(mean_visibility * (1 - mean_visibility));
}

}  // namespace halflight
