// A binary image packed 64 pixels to a word, so that one bitwise operation treats 64 pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace halflight {

// Bit x % 64 of word x / 64 of row y is pixel (x, y); row 0 is the top. Bits beyond the width are
// 0.
class BinaryImage {
 public:
  using Word = std::uint64_t;
  static constexpr int kWordBits = 64;

  BinaryImage() = default;
  BinaryImage(int width, int height, bool value = false);

  int width() const { return width_; }
  int height() const { return height_; }
  int words_per_row() const { return words_per_row_; }
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }

  bool at(int x, int y) const { return (row(y)[word_of(x)] >> (x % kWordBits)) & 1u; }
  void set(int x, int y, bool value = true) {
    const Word bit = Word{1} << (x % kWordBits);
    Word& word = row(y)[word_of(x)];
    word = value ? word | bit : word & ~bit;
  }

  std::span<Word> row(int y) { return {words_.data() + offset(y), stride()}; }
  std::span<const Word> row(int y) const { return {words_.data() + offset(y), stride()}; }
  std::span<Word> words() { return words_; }
  std::span<const Word> words() const { return words_; }
  // Valid bits of a row's last word. Whoever writes words directly keeps the others 0.
  Word last_word_mask() const {
    const int used = width_ % kWordBits;
    return used == 0 ? ~Word{0} : (Word{1} << used) - 1;
  }

  std::size_t count() const;  // set pixels
  bool any() const;

  friend bool operator==(const BinaryImage&, const BinaryImage&) = default;

 private:
  static std::size_t word_of(int x) { return static_cast<std::size_t>(x / kWordBits); }
  std::size_t stride() const { return static_cast<std::size_t>(words_per_row_); }
  std::size_t offset(int y) const { return static_cast<std::size_t>(y) * stride(); }

  int width_ = 0;
  int height_ = 0;
  int words_per_row_ = 0;
  std::vector<Word> words_;
};

BinaryImage complement(const BinaryImage& image);
// Both images have the same size.
BinaryImage unite(const BinaryImage& a, const BinaryImage& b);

}  // namespace halflight
