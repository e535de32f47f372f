// How much a scene file may ask for. A few hundred bytes can claim terabytes (repeated accessors,
// instances, compressed data), so every size is checked against these before memory is taken.
#pragma once

#include <cstddef>
#include <string>

#include "halflight/io/read_failure.h"

namespace halflight {

// About 10 GB when all are used; ids have 32 bits.
inline constexpr std::size_t kMaxVertices = std::size_t{1} << 27;
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;
inline constexpr std::size_t kMaxInstances = std::size_t{1} << 22;
inline constexpr std::size_t kMaxDecodedBytes = std::size_t{1} << 32;  // decompressed geometry
inline constexpr std::size_t kMaxZeroElements = std::size_t{1} << 24;  // accessors without data
inline constexpr std::size_t kMaxSceneTexels = std::size_t{1} << 30;

// Counts what has been asked for and fails when it passes the limit.
class ReadBudget {
 public:
  ReadBudget(std::string what, std::size_t limit) : what_(std::move(what)), limit_(limit) {}

  void take(std::size_t n, const std::string& where) {
    if (n > limit_ - used_)
      fail_reading("the scene asks for more than " + std::to_string(limit_) + " " + what_, where,
                   "simplify or split the scene");
    used_ += n;
  }

 private:
  std::string what_;
  std::size_t limit_;
  std::size_t used_ = 0;
};

}  // namespace halflight
