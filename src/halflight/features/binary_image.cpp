#include "halflight/features/binary_image.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace halflight {

BinaryImage::BinaryImage(int width, int height, bool value)
    : width_(width), height_(height), words_per_row_((width + kWordBits - 1) / kWordBits) {
  assert(width >= 0 && height >= 0);
  words_.assign(stride() * static_cast<std::size_t>(height), value ? ~Word{0} : Word{0});
  if (value && words_per_row_ > 0)
    for (int y = 0; y < height_; ++y) row(y).back() &= last_word_mask();
}

std::size_t BinaryImage::count() const {
  std::size_t n = 0;
  for (const Word w : words_) n += static_cast<std::size_t>(std::popcount(w));
  return n;
}

bool BinaryImage::any() const {
  return std::any_of(words_.begin(), words_.end(), [](Word w) { return w != 0; });
}

BinaryImage complement(const BinaryImage& image) {
  BinaryImage result = image;
  for (auto& w : result.words()) w = ~w;
  if (image.words_per_row() > 0)
    for (int y = 0; y < image.height(); ++y) result.row(y).back() &= image.last_word_mask();
  return result;
}

BinaryImage unite(const BinaryImage& a, const BinaryImage& b) {
  assert(a.width() == b.width() && a.height() == b.height());
  BinaryImage result = a;
  for (std::size_t i = 0; i < result.words().size(); ++i) result.words()[i] |= b.words()[i];
  return result;
}

}  // namespace halflight
