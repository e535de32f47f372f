#include "halflight/features/morphology.h"

#include <algorithm>
#include <vector>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

using Word = BinaryImage::Word;
constexpr int kWordBits = BinaryImage::kWordBits;
constexpr std::size_t kWordsPerTask = 1 << 15;  // about 10 us of work

std::size_t row_grain(const BinaryImage& image) {
  return kWordsPerTask / static_cast<std::size_t>(std::max(1, image.words_per_row())) + 1;
}

int margin_words(int n) { return (n + kWordBits - 1) / kWordBits; }

// The image within a frame of n or more pixels of `frame`, wide enough that no pixel of the image
// looks beyond it within n steps.
BinaryImage framed(const BinaryImage& image, int n, bool frame) {
  const int side = margin_words(n);
  BinaryImage result((image.words_per_row() + 2 * side) * kWordBits, image.height() + 2 * n, frame);
  for (int y = 0; y < image.height(); ++y) {
    const auto from = image.row(y);
    const auto to = result.row(y + n).subspan(static_cast<std::size_t>(side), from.size());
    std::copy(from.begin(), from.end(), to.begin());
    if (frame) to.back() |= ~image.last_word_mask();
  }
  return result;
}

BinaryImage unframed(const BinaryImage& image, int n, int width, int height) {
  BinaryImage result(width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = result.row(y);
    const auto from = image.row(y + n).subspan(static_cast<std::size_t>(margin_words(n)));
    std::copy_n(from.begin(), to.size(), to.begin());
    to.back() &= result.last_word_mask();
  }
  return result;
}

// out(x) = in(x - t) and in(x) and in(x + t), within one row; `guarded` is scratch.
void and_along_row(std::span<const Word> in, int t, std::span<Word> out,
                   std::vector<Word>& guarded) {
  const std::size_t whole = static_cast<std::size_t>(t / kWordBits);
  const int bits = t % kWordBits;
  const std::size_t guard = whole + 1;
  guarded.assign(in.size() + 2 * guard, 0);
  std::copy(in.begin(), in.end(), guarded.begin() + static_cast<std::ptrdiff_t>(guard));
  const Word* w = guarded.data() + guard;
  if (bits == 0) {
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = w[i] & w[i + whole] & *(w + i - whole);
    return;
  }
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Word right = (w[i + whole] >> bits) | (w[i + whole + 1] << (kWordBits - bits));
    const Word* left_words = w + i - whole;
    const Word left = (left_words[0] << bits) | (left_words[-1] >> (kWordBits - bits));
    out[i] = w[i] & right & left;
  }
}

void pass_along_rows(const BinaryImage& in, BinaryImage& out, int t) {
  const std::size_t rows = static_cast<std::size_t>(in.height());
  parallel_ranges(rows, row_grain(in), [&](std::size_t first, std::size_t last) {
    std::vector<Word> guarded;
    for (std::size_t y = first; y < last; ++y)
      and_along_row(in.row(static_cast<int>(y)), t, out.row(static_cast<int>(y)), guarded);
  });
}

// out(y) = out(y) and in(y - t) and in(y + t), row by row.
void pass_along_columns(const BinaryImage& in, BinaryImage& out, int t) {
  const std::size_t rows = static_cast<std::size_t>(in.height());
  parallel_for(rows, row_grain(in), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const auto target = out.row(y);
    if (y - t < 0 || y + t >= in.height()) {
      std::fill(target.begin(), target.end(), Word{0});
      return;
    }
    const auto above = in.row(y - t), below = in.row(y + t);
    for (std::size_t i = 0; i < target.size(); ++i) target[i] &= above[i] & below[i];
  });
}

// From radius r to r + t. Pixels beyond the frame count as clear: the frame is wide enough that
// this never reaches the image.
void grow_radius(BinaryImage& image, BinaryImage& scratch, int t, Connectivity connectivity) {
  pass_along_rows(image, scratch, t);
  if (connectivity == Connectivity::four) {
    pass_along_columns(image, scratch, t);  // diamond: both directions see the same image
    std::swap(image, scratch);
  } else {
    image = scratch;
    pass_along_columns(scratch, image, t);  // square: columns of what the rows left
  }
}

BinaryImage erode_framed(const BinaryImage& image, int n, Connectivity connectivity, bool frame) {
  n = std::min(n, std::max(image.width(), image.height()));
  if (n <= 0 || image.pixel_count() == 0) return image;
  BinaryImage current = framed(image, n, frame);
  BinaryImage scratch(current.width(), current.height());
  for (int radius = 0; radius < n;) {
    const int t = std::min(std::max(1, radius), n - radius);
    grow_radius(current, scratch, t, connectivity);
    radius += t;
  }
  return unframed(current, n, image.width(), image.height());
}

}  // namespace

BinaryImage erode(const BinaryImage& image, int n, Connectivity connectivity, Outside outside) {
  return erode_framed(image, n, connectivity, outside == Outside::ignored);
}

BinaryImage expand(const BinaryImage& image, int n, Connectivity connectivity) {
  return complement(erode_framed(complement(image), n, connectivity, true));
}

BinaryImage opening(const BinaryImage& image, int n, Connectivity connectivity, Outside outside) {
  return expand(erode(image, n, connectivity, outside), n, connectivity);
}

}  // namespace halflight
