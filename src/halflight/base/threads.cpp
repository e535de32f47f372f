#include "halflight/base/threads.h"

#include <algorithm>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace halflight {

int startable_threads(int most) {
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(std::max(0, most)));
  std::mutex gate;
  try {
    const std::lock_guard closed(gate);
    for (int i = 0; i < most; ++i)
      threads.emplace_back([&gate] { const std::lock_guard passed(gate); });
  } catch (const std::system_error&) {
    // There are no more.
  }
  for (std::thread& thread : threads) thread.join();
  return static_cast<int>(threads.size());
}

}  // namespace halflight
