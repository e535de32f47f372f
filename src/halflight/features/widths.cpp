#include "halflight/features/widths.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

#include "halflight/features/distance_transform.h"

namespace halflight {
namespace {

constexpr int kErosionLimit = 128;  // pixels; wider or taller images take the distance route

using Word = BinaryImage::Word;

template <std::size_t W>
using Rows = std::vector<std::array<Word, W>>;

template <std::size_t W>
bool any_set(const Rows<W>& rows) {
  Word set = 0;
  for (const auto& row : rows)
    for (const Word w : row) set |= w;
  return set != 0;
}

// out(x, y) = all of the 2 x 2 pixels from (x, y) on, in place: a row reads itself and the next,
// which is still unchanged then. The last row has no next and goes.
template <std::size_t W>
void erode_by_2x2(Rows<W>& rows) {
  for (std::size_t y = 0; y + 1 < rows.size(); ++y) {
    std::array<Word, W> both;
    for (std::size_t i = 0; i < W; ++i) both[i] = rows[y][i] & rows[y + 1][i];
    for (std::size_t i = 0; i < W; ++i)
      rows[y][i] = both[i] & ((both[i] >> 1) | (i + 1 < W ? both[i + 1] << 63 : 0));
  }
  rows.pop_back();
}

template <std::size_t W>
int count_2x2_erosions(const BinaryImage& image) {
  Rows<W> rows(static_cast<std::size_t>(image.height()));
  for (int y = 0; y < image.height(); ++y) {
    const auto row = image.row(y);
    std::copy(row.begin(), row.end(), rows[static_cast<std::size_t>(y)].begin());
    std::fill(rows[static_cast<std::size_t>(y)].begin() + image.words_per_row(),
              rows[static_cast<std::size_t>(y)].end(), Word{0});
  }
  int erosions = 0;
  for (; any_set(rows); ++erosions) erode_by_2x2(rows);
  return erosions;
}

}  // namespace

int largest_square_by_erosion(const BinaryImage& image) {
  assert(image.width() <= kErosionLimit);
  return image.words_per_row() <= 1 ? count_2x2_erosions<1>(image) : count_2x2_erosions<2>(image);
}

// side(x, y) of the largest square whose lower right corner is (x, y): one more than the smallest
// of those at the left, above and diagonally between.
int largest_square_by_distance(const BinaryImage& image) {
  std::vector<int> side(static_cast<std::size_t>(image.width()) + 1, 0);  // side[x + 1] is column x
  int largest = 0;
  for (int y = 0; y < image.height(); ++y) {
    int diagonal = 0;
    for (std::size_t x = 1; x < side.size(); ++x) {
      const int above = side[x];
      side[x] =
          image.at(static_cast<int>(x) - 1, y) ? 1 + std::min({above, side[x - 1], diagonal}) : 0;
      diagonal = above;
      largest = std::max(largest, side[x]);
    }
  }
  return largest;
}

int largest_square(const BinaryImage& image) {
  return std::max(image.width(), image.height()) <= kErosionLimit
             ? largest_square_by_erosion(image)
             : largest_square_by_distance(image);
}

int blocked_width(const BinaryImage& image) { return largest_square(image); }

int free_width(const BinaryImage& image) { return largest_square(complement(image)); }

int erosions_until_empty(const BinaryImage& image, Connectivity connectivity) {
  if (connectivity == Connectivity::eight) return (largest_square(image) + 1) / 2;
  const auto distance = distance_to_clear(image, connectivity, Outside::clear);
  const auto farthest = std::max_element(distance.begin(), distance.end());
  return farthest == distance.end() ? 0 : static_cast<int>(*farthest);
}

}  // namespace halflight
