// Typed indices into arrays: an id of one kind does not compile where another kind is wanted.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace halflight {

template <class Tag>
struct Id {
  static constexpr std::uint32_t kInvalid = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = kInvalid;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  constexpr bool valid() const { return value != kInvalid; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

// A vector indexed by one kind of id.
template <class IdT, class T>
class IdVector {
 public:
  IdVector() = default;
  explicit IdVector(std::size_t n, const T& v = T()) : items_(n, v) {}

  auto& operator[](IdT id) { return items_[id.value]; }
  const auto& operator[](IdT id) const { return items_[id.value]; }
  IdT push_back(T v) {
    items_.push_back(std::move(v));
    return IdT(items_.size() - 1);
  }
  bool contains(IdT id) const { return id.value < items_.size(); }
  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  void resize(std::size_t n, const T& v = T()) { items_.resize(n, v); }
  void reserve(std::size_t n) { items_.reserve(n); }
  void clear() { items_.clear(); }
  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  T& back() { return items_.back(); }
  std::span<T> span() { return items_; }
  std::span<const T> span() const { return items_; }
  std::vector<T>& raw() { return items_; }
  const std::vector<T>& raw() const { return items_; }

 private:
  std::vector<T> items_;
};

// Half-open run of consecutive ids.
template <class IdT>
struct IdRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;

  struct Iterator {
    std::uint32_t value;
    IdT operator*() const { return IdT(value); }
    Iterator& operator++() {
      ++value;
      return *this;
    }
    bool operator!=(const Iterator& o) const { return value != o.value; }
  };
  Iterator begin() const { return {first}; }
  Iterator end() const { return {last}; }
  std::uint32_t size() const { return last - first; }
  bool empty() const { return first == last; }
  IdT operator[](std::size_t i) const { return IdT(first + i); }
};

}  // namespace halflight
