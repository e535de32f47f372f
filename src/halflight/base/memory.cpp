#include "halflight/base/memory.h"

#include <malloc.h>
#include <sys/resource.h>

namespace halflight {

std::size_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

void return_free_memory() { malloc_trim(0); }

}  // namespace halflight
