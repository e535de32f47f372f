// Whether this build watches itself: then it is many times slower, and needs more memory and
// threads than any limit that a test may set.
#pragma once

namespace halflight::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace halflight::test
