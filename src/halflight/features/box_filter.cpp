#include "halflight/features/box_filter.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

using Sum = glm::dvec3;
// Lines filtered side by side: columns share cache lines, rows fall into the same cache sets.
constexpr std::size_t kColumns = 64;
constexpr std::size_t kRows = 2;

// One axis of the square: `reach` whole pixels to either side, then `part` of the next.
struct Window {
  int reach = 0;
  double part = 0;

  explicit Window(double size) {
    const double side = std::max(0.0, (size - 1) / 2);
    reach = static_cast<int>(std::min(side, 1e9));
    part = side - std::floor(side);
  }
};

// Parallel lines of n pixels each: pixel i of line k is at [i * along + k * across].
struct Lines {
  std::size_t along, across;
  int n;
};

// Filters sums.size() neighbouring lines side by side with running sums in double. `dark` is as
// many black pixels, with the same stride, for what lies beyond the ends.
void filter_bundle(const Rgb* in, Rgb* out, Lines lines, Window w, std::span<Sum> sums,
                   const Rgb* dark) {
  const long n = lines.n, reach = std::min<long>(w.reach, n);
  const auto inside = [&](long i) { return i >= 0 && i < n; };
  const auto pixel = [&](long i) {
    return inside(i) ? in + static_cast<std::size_t>(i) * lines.along : dark;
  };
  for (long i = -reach; i < n; ++i) {
    const Rgb *entering = pixel(i + reach), *leaving = pixel(i - reach - 1),
              *next = pixel(i + reach + 1);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k] += Sum(entering[k * lines.across]) - Sum(leaving[k * lines.across]);
    if (i < 0) continue;
    const long whole = std::min(n - 1, i + reach) - std::max(0L, i - reach) + 1;
    const int partial = int{inside(i - reach - 1)} + int{inside(i + reach + 1)};
    const double inverse = 1 / (static_cast<double>(whole) + w.part * partial);
    Rgb* to = out + static_cast<std::size_t>(i) * lines.along;
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const Sum edges = Sum(leaving[k * lines.across]) + Sum(next[k * lines.across]);
      to[k * lines.across] = Rgb((sums[k] + w.part * edges) * inverse);
    }
  }
}

void filter_lines(const Rgb* in, Rgb* out, Lines lines, std::size_t count, std::size_t side_by_side,
                  Window w) {
  const std::vector<Rgb> dark(side_by_side * lines.across, Rgb(0.f));
  parallel_for((count + side_by_side - 1) / side_by_side, 1, [&](std::size_t bundle) {
    const std::size_t first = bundle * side_by_side;
    std::vector<Sum> sums(std::min(side_by_side, count - first), Sum(0));
    filter_bundle(in + first * lines.across, out + first * lines.across, lines, w, sums,
                  dark.data());
  });
}

}  // namespace

Image box_filter(const Image& image, double size) {
  if (size <= 1) return image;
  const Window window(size);
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  Image rows(image.width, image.height), result(image.width, image.height);
  filter_lines(image.pixels.data(), rows.pixels.data(), {1, width, image.width}, height, kRows,
               window);
  filter_lines(rows.pixels.data(), result.pixels.data(), {width, 1, image.height}, width, kColumns,
               window);
  return result;
}

}  // namespace halflight
