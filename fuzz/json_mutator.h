// Changes a JSON document by its values rather than its characters.
#pragma once

#include <cstddef>
#include <string>

namespace halflight::fuzz {

// At most `most` bytes, or empty when it is no JSON; all follows from the seed.
std::string mutated_json(const std::string& text, unsigned seed, std::size_t most);

}  // namespace halflight::fuzz
