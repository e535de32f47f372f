#include "halflight/io/atomic_file.h"

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <memory>

#include <unistd.h>

#include "halflight/base/one_line.h"

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

// Names that are nearly as long as they may be lose their end.
std::filesystem::path beside(const std::filesystem::path& path) {
  const std::string ending = ".partial-" + std::to_string(::getpid());
  const std::string name = path.filename().string();
  return path.parent_path() / (std::string(utf8_prefix(name, NAME_MAX - ending.size())) + ending);
}

bool write_all(std::FILE* f, std::span<const std::byte> bytes) {
  return std::fwrite(bytes.data(), 1, bytes.size(), f) == bytes.size() && std::fflush(f) == 0;
}

}  // namespace

bool is_written_in_place(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  if (std::filesystem::is_directory(status) || !std::filesystem::exists(status)) return false;
  if (!std::filesystem::is_regular_file(status)) return true;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(path, unknown))) return false;
  const auto folder = std::filesystem::canonical(path.parent_path(), unknown);
  return folder == "/dev" || folder.string().starts_with("/proc/");
}

Result<void> write_file_atomically(const std::filesystem::path& path,
                                   std::span<const std::byte> bytes) {
  std::error_code ignored;
  if (is_written_in_place(path) || std::filesystem::is_directory(path, ignored)) {
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
  if (is_written_in_place(path)) return {};
  std::error_code failure, ignored;
  const auto status = std::filesystem::status(path, failure);
  const bool too_long = failure == std::errc::filename_too_long;
  if (std::filesystem::is_directory(status) || too_long) {
    errno = too_long ? ENAMETOOLONG : EISDIR;
    return cannot_write(path);
  }
  const std::filesystem::path partial = beside(path);
  if (!File(std::fopen(partial.c_str(), "wb"))) return cannot_write(path);
  std::filesystem::remove(partial, ignored);
  return {};
}

}  // namespace halflight
