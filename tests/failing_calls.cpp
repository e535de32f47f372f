// Loaded before the program: calls that fail as no test can make them fail in earnest.
// No connection is accepted, as the system's table of files is full; with FAILING_ZSTD=N zstd's
// N-th request for memory is refused.
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <sys/socket.h>

namespace {

bool is_in_zstd(const void* address) {
  Dl_info place{};
  return dladdr(address, &place) != 0 && place.dli_fname && std::strstr(place.dli_fname, "zstd");
}

int g_requests = 0;
thread_local bool t_looking = false;  // dladdr may ask for memory, too

}  // namespace

extern "C" int accept(int, sockaddr*, socklen_t*) {
  errno = ENFILE;
  return -1;
}

extern "C" void* malloc(std::size_t size) noexcept {
  using Malloc = void* (*)(std::size_t);
  static const auto real = reinterpret_cast<Malloc>(dlsym(RTLD_NEXT, "malloc"));
  const char* failing = t_looking ? nullptr : std::getenv("FAILING_ZSTD");
  if (failing) {
    t_looking = true;
    const bool is_zstd = is_in_zstd(__builtin_return_address(0));
    t_looking = false;
    if (is_zstd && ++g_requests == std::atoi(failing)) return nullptr;
  }
  return real(size);
}
