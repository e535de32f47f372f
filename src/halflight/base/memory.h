// What the process holds of the machine's memory.
#pragma once

#include <cstddef>

namespace halflight {

std::size_t peak_resident_bytes();  // most so far

// Gives freed memory back to the system, as far as it can be.
void return_free_memory();

}  // namespace halflight
