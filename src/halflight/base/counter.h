// Counts events of many threads without their getting in each other's way.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace halflight {

class Counter {
 public:
  void add(std::uint64_t n = 1) {
    slots_[slot_of_thread()].count.fetch_add(n, std::memory_order_relaxed);
  }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const Slot& s : slots_) sum += s.count.load(std::memory_order_relaxed);
    return sum;
  }

 private:
  static constexpr std::size_t kSlots = 32;  // threads beyond share them
  struct alignas(64) Slot {                  // a cache line each
    std::atomic<std::uint64_t> count{0};
  };
  static std::size_t slot_of_thread() {
    static std::atomic<std::size_t> next{0};
    thread_local const std::size_t slot = next.fetch_add(1, std::memory_order_relaxed) % kSlots;
    return slot;
  }

  std::array<Slot, kSlots> slots_;
};

}  // namespace halflight
