// The light of the view mesh as it changes: each frame gets a version, and who knows one version is
// told what differs since.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight {

// Thread-safe. Readers share what they read with the writer and never wait for each other.
class LightFrames {
 public:
  // A new mesh: all that was known of the light is void.
  void begin(std::uint32_t epoch);
  // Returns the frame's version.
  std::uint64_t add(std::uint32_t epoch, std::span<const Rgb> irradiance, float exposure);

  // What changed since a version (0: everything), as a packet; the whole frame when the epoch that
  // the reader knows is another one. Empty: there is no light yet.
  std::string since(std::uint32_t epoch, std::uint64_t version) const;
  std::uint64_t version() const;

 private:
  struct Frame {
    std::uint32_t epoch = 0;
    bool has_light = false;  // that of no vertices, where nothing is shown
    std::uint64_t version = 0;
    float exposure = 1.f;
    float scale = 0.f;  // a power of two near the mean irradiance, as floats of 5 bits span little
    std::vector<std::uint32_t> light;         // RGB9_E5 of every vertex's irradiance over the scale
    std::vector<std::uint64_t> last_changes;  // versions, of blocks of kBlock vertices
  };
  static constexpr std::size_t kBlock = 512;

  mutable std::mutex mutex_;
  std::shared_ptr<const Frame> frame_ = std::make_shared<Frame>();
};

}  // namespace halflight
