#include "halflight/base/parallel.h"

#include <algorithm>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include "halflight/base/threads.h"

#ifdef HALFLIGHT_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace halflight {
namespace {

// Never given back: oneTBB would start all its threads as the program ends.
tbb::global_control* g_thread_limit = nullptr;
int g_thread_count = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));

// oneTBB ends the program when it cannot start a thread, so it is told of no more than there are.
// Some are left for others: deadlines, the live view.
int threads_within(int wanted) {
  constexpr int kSpare = 2;
  const int others = startable_threads(wanted - 1 + kSpare);
  return others == wanted - 1 + kSpare ? wanted : std::max(1, 1 + others - kSpare);
}

// oneTBB is not instrumented, so the thread sanitizer cannot see that a loop's bodies run after the
// loop is entered and before it is left. These two say so; in other builds they do nothing.
#ifdef HALFLIGHT_THREAD_SANITIZER
void tell_sanitizer_before(void* point) { __tsan_release(point); }
void tell_sanitizer_after(void* point) { __tsan_acquire(point); }
#else
void tell_sanitizer_before(void*) {}
void tell_sanitizer_after(void*) {}
#endif

}  // namespace

void set_thread_count(int n) {
  constexpr int kMost = 1 << 16;  // more than any machine has
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  g_thread_count = threads_within(n > 0 ? std::min(n, kMost) : all);
  const tbb::global_control* before = g_thread_limit;
  g_thread_limit = new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                           static_cast<std::size_t>(g_thread_count));
  delete before;
}

int thread_count() { return g_thread_count; }

void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  char entered = 0, left = 0;
  tell_sanitizer_before(&entered);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, std::max<std::size_t>(1, grain)),
                    [&](const tbb::blocked_range<std::size_t>& r) {
                      tell_sanitizer_after(&entered);
                      body(r.begin(), r.end());
                      tell_sanitizer_before(&left);
                    });
  tell_sanitizer_after(&left);
}

}  // namespace halflight
