#include "halflight/base/morton_order.h"

#include <array>
#include <numeric>

namespace halflight {
namespace {

constexpr int kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

struct KeyedIndex {
  std::uint64_t key;
  std::uint32_t index;
};

}  // namespace

std::vector<std::uint32_t> order_by_key(std::span<const std::uint64_t> keys) {
  std::vector<KeyedIndex> sorted(keys.size()), other(keys.size());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) sorted[i] = {keys[i], i};
  for (int shift = 0; shift < 64; shift += kDigitBits) {
    std::array<std::size_t, kDigits> starts{};
    const auto digit = [&](const KeyedIndex& k) { return (k.key >> shift) & (kDigits - 1); };
    for (const KeyedIndex& k : sorted) ++starts[digit(k)];
    if (!sorted.empty() && starts[digit(sorted.front())] == sorted.size()) continue;
    std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), std::size_t{0});
    for (const KeyedIndex& k : sorted) other[starts[digit(k)]++] = k;
    sorted.swap(other);
  }
  std::vector<std::uint32_t> order(sorted.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = sorted[i].index;
  return order;
}

}  // namespace halflight
