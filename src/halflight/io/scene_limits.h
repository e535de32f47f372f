// How much a scene file may ask for. A few hundred bytes can claim terabytes (repeated accessors,
// instances, compressed data), so every size is checked against these before memory is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "halflight/io/read_failure.h"

namespace halflight {

// A fuzzer would spend its time on filling memory: it gets by with a 4096th.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
inline constexpr int kFewer = 12;
#else
inline constexpr int kFewer = 0;
#endif

// About 10 GB when all are used; ids have 32 bits.
inline constexpr std::size_t kMaxVertices = std::size_t{1} << (27 - kFewer);
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << (28 - kFewer);
inline constexpr std::size_t kMaxInstances = std::size_t{1} << (22 - kFewer);
// Decompressed geometry.
inline constexpr std::size_t kMaxDecodedBytes = std::size_t{1} << (32 - kFewer);
// Of accessors without data.
inline constexpr std::size_t kMaxZeroElements = std::size_t{1} << (24 - kFewer);
inline constexpr std::size_t kMaxSceneTexels = std::size_t{1} << (30 - kFewer);
// Of pictures as they are stored, which the lit scene holds again.
inline constexpr std::size_t kMaxPictureBytes = std::size_t{1} << (31 - kFewer);
// A picture above this size is refused before memory is taken (16384 x 8192: 0.5 GB): a flat PNG
// of a few kilobytes can claim any size.
inline constexpr std::size_t kMaxTexels = std::size_t{1} << (27 - kFewer);
// The same of a picture of floats (0.8 GB).
inline constexpr std::int64_t kMaxFloatPixels = std::int64_t{1} << (26 - kFewer);
// Squares of the corners of large faces of OBJ files: seconds of cutting them into triangles.
inline constexpr std::size_t kMaxCuttingEffort = std::size_t{1} << (30 - kFewer);
// Material libraries that an OBJ file names, there or not.
inline constexpr std::size_t kMaxLibraries = 1024;
// Bytes of one name: many things can have the same one, and each keeps it and writes it out.
inline constexpr std::size_t kLongestName = 4096;
// Of all groups together: each holds the name of its object, too.
inline constexpr std::size_t kMaxNameBytes = std::size_t{1} << (27 - kFewer);

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

inline std::string_view checked_name(std::string_view name, const std::filesystem::path& file,
                                     std::size_t line) {
  if (name.size() > kLongestName)
    fail_reading("a name is longer than " + std::to_string(kLongestName) + " bytes",
                 file.string() + ":" + std::to_string(line), "shorten it");
  return name;
}

}  // namespace halflight
