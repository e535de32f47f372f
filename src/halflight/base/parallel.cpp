#include "halflight/base/parallel.h"

#include <memory>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace halflight {
namespace {

std::unique_ptr<tbb::global_control> g_thread_limit;
int g_thread_count = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));

}  // namespace

void set_thread_count(int n) {
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  g_thread_count = n > 0 ? n : all;
  g_thread_limit = std::make_unique<tbb::global_control>(
      tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(g_thread_count));
}

int thread_count() { return g_thread_count; }

void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, std::max<std::size_t>(1, grain)),
                    [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
}

}  // namespace halflight
