// Whether this build watches itself: then it is many times slower, and needs more memory and
// threads than any limit that a test may set.
#pragma once

namespace halflight::test {

#ifdef __SANITIZE_THREAD__
inline constexpr bool kThreadSanitized = true;  // the slowest, and it holds signals back
#else
inline constexpr bool kThreadSanitized = false;
#endif

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = kThreadSanitized;
#endif

}  // namespace halflight::test
