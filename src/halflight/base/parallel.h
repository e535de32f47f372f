// Parallel loops. The only room file pair that names oneTBB is this header's source.
// Determinism: a loop body writes only what belongs to its own index, so results are the same bytes
// for any number of threads; reductions add up fixed-size blocks in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace halflight {

// Limits all parallel loops to n threads; 0 means all cores. Call once, before any loop.
void set_thread_count(int n);
int thread_count();

// Runs body(first, last) over disjoint sub-ranges of [0, n) of at least `grain` indices.
void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

template <class Body>
void parallel_for(std::size_t n, std::size_t grain, const Body& body) {
  parallel_ranges(n, grain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

// Ordered concatenation: each block of `grain` indices appends to its own vector with
// body(first, last, out); the vectors are joined in index order.
template <class T, class Body>
std::vector<T> parallel_collect_blocks(std::size_t n, std::size_t grain, const Body& body) {
  const std::size_t blocks = (n + grain - 1) / grain;
  std::vector<std::vector<T>> parts(blocks);
  parallel_for(blocks, 1,
               [&](std::size_t b) { body(b * grain, std::min(n, (b + 1) * grain), parts[b]); });
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> joined;
  joined.reserve(total);
  for (auto& part : parts) {
    joined.insert(joined.end(), part.begin(), part.end());
    std::vector<T>().swap(part);
  }
  return joined;
}

// The same, index by index, with body(index, out).
template <class T, class Body>
std::vector<T> parallel_collect(std::size_t n, std::size_t grain, const Body& body) {
  return parallel_collect_blocks<T>(n, grain,
                                    [&](std::size_t first, std::size_t last, std::vector<T>& out) {
                                      for (std::size_t i = first; i < last; ++i) body(i, out);
                                    });
}

// Sum of body(i) over [0, n): blocks of `grain` are added in order, whatever the thread count.
template <class T, class Body>
T parallel_sum(std::size_t n, std::size_t grain, T zero, const Body& body) {
  const std::size_t blocks = (n + grain - 1) / grain;
  std::vector<T> parts(blocks, zero);
  parallel_for(blocks, 1, [&](std::size_t b) {
    const std::size_t last = std::min(n, (b + 1) * grain);
    for (std::size_t i = b * grain; i < last; ++i) parts[b] += body(i);
  });
  T total = zero;
  for (const T& part : parts) total += part;
  return total;
}

// `less` orders any two different elements, so that there is one result.
template <class T, class Less>
void parallel_sort(std::vector<T>& list, const Less& less) {
  constexpr std::size_t kSortedAtOnce = 1 << 16;
  const auto at = [&](std::size_t i) {
    return list.begin() + static_cast<std::ptrdiff_t>(std::min(i, list.size()));
  };
  const auto runs_of = [&](std::size_t length) { return (list.size() + length - 1) / length; };
  parallel_for(runs_of(kSortedAtOnce), 1, [&](std::size_t r) {
    std::sort(at(r * kSortedAtOnce), at((r + 1) * kSortedAtOnce), less);
  });
  for (std::size_t length = kSortedAtOnce; length < list.size(); length *= 2)
    parallel_for(runs_of(2 * length), 1, [&](std::size_t r) {
      const std::size_t first = 2 * r * length;
      std::inplace_merge(at(first), at(first + length), at(first + 2 * length), less);
    });
}

}  // namespace halflight
