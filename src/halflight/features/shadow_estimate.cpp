#include "halflight/features/shadow_estimate.h"

#include <algorithm>
#include <vector>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr float kLitShare = 0.95f;  // of the lit level: fainter dips are shading or rounding
constexpr int kCells = 256;  // the lit level is smooth: this many cells along the shorter side

struct Grid {
  int width = 0, height = 0;
  std::vector<float> values;
  float& at(int x, int y) { return values[index(x, y)]; }
  float at(int x, int y) const { return values[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// Largest luminance of every cell of `cell` x `cell` pixels.
Grid brightest_of_cells(const Image& image, int cell) {
  Grid grid{(image.width + cell - 1) / cell, (image.height + cell - 1) / cell, {}};
  grid.values.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                     0);
  parallel_for(static_cast<std::size_t>(grid.height), 1, [&](std::size_t row) {
    const int first = static_cast<int>(row) * cell, last = std::min(image.height, first + cell);
    for (int y = first; y < last; ++y)
      for (int x = 0; x < image.width; ++x) {
        float& value = grid.at(x / cell, static_cast<int>(row));
        value = std::max(value, luminance(image.at(x, y)));
      }
  });
  return grid;
}

// Extreme of each value's neighbours within `radius` along one axis; `better` prefers its first.
template <class Better>
Grid extreme_along(const Grid& in, int radius, bool horizontal, Better better) {
  Grid out = in;
  const int n = horizontal ? in.width : in.height;
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      const int here = horizontal ? x : y;
      for (int k = std::max(0, here - radius); k <= std::min(n - 1, here + radius); ++k) {
        const float seen = horizontal ? in.at(k, y) : in.at(x, k);
        if (better(seen, out.at(x, y))) out.at(x, y) = seen;
      }
    }
  return out;
}

// Continues the border values outwards, so that light which fades towards the border stays as it
// is.
Grid framed(const Grid& grid, int margin) {
  Grid out{grid.width + 2 * margin, grid.height + 2 * margin, {}};
  out.values.reserve(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.values.push_back(grid.at(std::clamp(x - margin, 0, grid.width - 1),
                                   std::clamp(y - margin, 0, grid.height - 1)));
  return out;
}

Grid closing(const Grid& grid, int radius) {
  const auto brighter = [](float a, float b) { return a > b; };
  const auto darker = [](float a, float b) { return a < b; };
  const Grid dilated =
      extreme_along(extreme_along(grid, radius, true, brighter), radius, false, brighter);
  return extreme_along(extreme_along(dilated, radius, true, darker), radius, false, darker);
}

}  // namespace

BinaryImage estimate_shadow(const Image& image) {
  BinaryImage shadow(image.width, image.height);
  if (shadow.pixel_count() == 0) return shadow;
  const int cell = std::max(1, std::min(image.width, image.height) / kCells);
  const Grid cells = brightest_of_cells(image, cell);
  const int radius = std::min(cells.width, cells.height) / 4, margin = 2 * radius;
  const Grid lit = closing(framed(cells, margin), radius);
  parallel_for(static_cast<std::size_t>(image.height), 16, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.width; ++x)
      if (luminance(image.at(x, y)) < kLitShare * lit.at(x / cell + margin, y / cell + margin))
        shadow.set(x, y);
  });
  return shadow;
}

}  // namespace halflight
