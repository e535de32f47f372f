#include "halflight/io/atomic_file.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "halflight/base/one_line.h"

namespace halflight {
namespace {

class OpenFile {
 public:
  OpenFile(const std::filesystem::path& path, int how)
      : descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | how, 0666)) {}
  ~OpenFile() {
    const int reason = errno;
    if (is_open()) ::close(descriptor_);
    errno = reason;
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno != EINTR) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(0, n)));
    }
    return true;
  }

 private:
  int descriptor_;
};

tl::unexpected<Error> cannot_write(const std::filesystem::path& path) {
  return system_error(std::string("cannot write: ") + std::strerror(errno), path.string(),
                      "check that the folder exists, is writable and has room");
}

// A file in the folder of another that nobody else has: others may write the same output, and
// processes of other machines and containers may have the same number. It has the rights of the
// file that it is to replace, and is gone unless it does.
class FileBeside {
 public:
  explicit FileBeside(const std::filesystem::path& path) : path_(path) {
    std::random_device random;
    do {
      name_ = beside(path, fmt::format(".partial-{:08x}", random()));
      file_.emplace(name_, O_EXCL);
    } while (!file_->is_open() && errno == EEXIST);
    struct stat before {};
    if (file_->is_open() && ::stat(path.c_str(), &before) == 0)
      ::fchmod(file_->descriptor(), before.st_mode & 0777);
  }
  ~FileBeside() {
    const int reason = errno;
    if (file_->is_open() && !in_place_) ::unlink(name_.c_str());
    errno = reason;
  }
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  bool is_open() const { return file_->is_open(); }
  bool write(std::span<const std::byte> bytes) const {
    return file_->write(bytes) && ::fsync(file_->descriptor()) == 0;
  }
  bool replace() { return in_place_ = std::rename(name_.c_str(), path_.c_str()) == 0; }

 private:
  // Names that are nearly as long as they may be lose their end.
  static std::filesystem::path beside(const std::filesystem::path& path,
                                      const std::string& ending) {
    const std::string name = path.filename().string();
    return path.parent_path() / (std::string(utf8_prefix(name, NAME_MAX - ending.size())) + ending);
  }

  std::filesystem::path path_, name_;
  std::optional<OpenFile> file_;
  bool in_place_ = false;
};

// Where a link leads, if there is a file.
std::filesystem::path file_behind(const std::filesystem::path& path) {
  std::error_code failure;
  if (!std::filesystem::is_symlink(path, failure)) return path;
  auto file = std::filesystem::canonical(path, failure);
  return failure ? path : file;
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
    const OpenFile file(path, O_TRUNC);
    if (!file.is_open() || !file.write(bytes)) return cannot_write(path);
    return {};
  }
  FileBeside partial(file_behind(path));
  if (!partial.is_open() || !partial.write(bytes) || !partial.replace()) return cannot_write(path);
  return {};
}

Result<void> check_writable(const std::filesystem::path& path) {
  if (path.empty()) return {};
  if (is_written_in_place(path)) return {};
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  const bool too_long = failure == std::errc::filename_too_long;
  if (std::filesystem::is_directory(status) || too_long) {
    errno = too_long ? ENAMETOOLONG : EISDIR;
    return cannot_write(path);
  }
  if (!FileBeside(file_behind(path)).is_open()) return cannot_write(path);
  return {};
}

}  // namespace halflight
