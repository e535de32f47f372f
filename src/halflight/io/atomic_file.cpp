#include "halflight/io/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <unistd.h>

namespace halflight {
namespace {

struct CloseFile {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

tl::unexpected<Error> cannot_write(const std::filesystem::path& path) {
  return system_error(std::string("cannot write: ") + std::strerror(errno), path.string(),
                      "check that the folder exists, is writable and has room");
}

std::filesystem::path beside(const std::filesystem::path& path) {
  std::filesystem::path name = path;
  name += ".partial-" + std::to_string(::getpid());
  return name;
}

bool write_all(std::FILE* f, std::span<const std::byte> bytes) {
  return std::fwrite(bytes.data(), 1, bytes.size(), f) == bytes.size() && std::fflush(f) == 0;
}

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& path,
                                   std::span<const std::byte> bytes) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    const File f(std::fopen(path.c_str(), "wb"));
    if (!f || !write_all(f.get(), bytes)) return cannot_write(path);
    return {};
  }

  const std::filesystem::path partial = beside(path);
  File f(std::fopen(partial.c_str(), "wb"));
  if (!f) return cannot_write(path);
  bool written = write_all(f.get(), bytes) && ::fsync(::fileno(f.get())) == 0;
  f.reset();
  written = written && std::rename(partial.c_str(), path.c_str()) == 0;
  if (!written) {
    const auto error = cannot_write(path);
    std::filesystem::remove(partial, ignored);
    return error;
  }
  return {};
}

Result<void> check_writable(const std::filesystem::path& path) {
  if (path.empty()) return {};
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) {
    errno = EISDIR;
    return cannot_write(path);
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return {};
  const std::filesystem::path partial = beside(path);
  if (!File(std::fopen(partial.c_str(), "wb"))) return cannot_write(path);
  std::filesystem::remove(partial, ignored);
  return {};
}

}  // namespace halflight
