// meshoptimizer's streams alone. The first four bytes choose mode, filter, stride and count.
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fuzz_target.h"
#include "halflight/io/gltf_meshopt.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  if (size < 4) return 0;
  constexpr std::array<const char*, 3> kModes{"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr std::array<const char*, 4> kFilters{"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  const nlohmann::json extension = {{"mode", kModes[data[0] % kModes.size()]},
                                    {"filter", kFilters[data[1] % kFilters.size()]},
                                    {"byteStride", data[2]},
                                    {"count", data[3] * (data[0] / 3u + 1u)}};
  ReadBudget budget("bytes", kMaxDecodedBytes);
  try {
    // A copy of its own: reading beyond its end shows.
    const Bytes stream = fuzz::bytes_of(data + 4, size - 4);
    decode_meshopt(JsonCursor(extension, "scene.gltf"), stream, budget);
  } catch (const ReadFailure& failure) {
    fuzz::require_clear(failure.error);
  }
  return 0;
}
