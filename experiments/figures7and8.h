// Figures 7 and 8: one office with every hierarchy, by surface visibility and by average
// visibility.
#pragma once

#include <string>
#include <vector>

#include "halflight/base/image.h"

namespace halflight::experiments {

// A hierarchy in figure 8. Irradiance under the desks is direct light, as a share of the exact.
struct AverageOffice {
  std::string hierarchy;
  std::size_t clusters = 0;
  double exact_seconds = 0;    // surfaces tested exactly in the hierarchy's own tree
  double average_seconds = 0;  // the same rays by extinction alone
  double exact_nodes = 0;      // for each ray
  double average_nodes = 0;
  double under_desks = 0;            // clusters that hold an end of the ray are opened (ours)
  double under_desks_published = 0;  // they are not, and surfaces fill their clusters (the paper)
  Image picture;                     // direct light, as the paper has it; 1 is white
  Image published_picture;
};
// The exact one first, then every hierarchy; the k-d tree also in its published form.
std::vector<AverageOffice> light_office_by_extinction(int width, int height);

}  // namespace halflight::experiments
