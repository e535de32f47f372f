// For targets that read JSON: half of all changes are to values, the others to characters.
#include <algorithm>
#include <cstdint>

#include "json_mutator.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  if (seed % 2 == 0) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    const std::string changed = halflight::fuzz::mutated_json(text, seed / 2, most);
    if (!changed.empty()) {
      std::copy(changed.begin(), changed.end(), data);
      return changed.size();
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
