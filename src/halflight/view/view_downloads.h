// Files that a user of the live view takes home: the lit scene and a picture of full range.
#pragma once

#include <string>

#include "halflight/view/view_session.h"

namespace halflight {

// As `halflight solve -o` writes it. Of no use once cancelled.
Result<std::string> lit_glb(const SolutionCopy& solution, const Progress& progress);

// OpenEXR, as `halflight render` writes it. At most kLargestPicture pixels on a side.
inline constexpr int kLargestPicture = 2048;
Result<std::string> hdr_picture(const SolutionCopy& solution, const ViewOfInterest& view,
                                const Progress& progress);

}  // namespace halflight
