// Changes the JSON or the binary chunk of a GLB and keeps its lengths right; now and then only
// bytes.
#include <algorithm>

#include "glb_file.h"
#include "json_mutator.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  using namespace halflight;
  auto glb = fuzz::GlbFile::parse(data, size);
  if (!glb || seed % 8 == 0) return LLVMFuzzerMutate(data, size, most);
  if (seed % 8 < 3) {
    const std::size_t length = glb->binary.size();
    glb->binary.resize(length + 32);
    glb->binary.resize(LLVMFuzzerMutate(glb->binary.data(), length, glb->binary.size()));
  } else if (std::string json = fuzz::mutated_json(glb->json, seed / 8, most); !json.empty()) {
    glb->json = std::move(json);
  }
  const Bytes file = glb->bytes();
  if (file.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(file.begin(), file.end(), data);
  return file.size();
}
