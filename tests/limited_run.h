// Runs the program where the system gives it less than it wants.
#pragma once

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

namespace halflight::test {

// What `prepare` does before the program starts: limits, rights. False: it cannot be done here.
using Preparation = std::function<bool()>;
inline constexpr int kCannotPrepare = 125;

// Exit status, or minus the signal that ended it. What it prints goes to files "out" and "err".
inline int run_limited(const std::filesystem::path& folder, const std::string& binary,
                       const std::string& arguments, const Preparation& prepare) {
  const std::string line = "cd '" + folder.string() + "' && exec '" + binary + "' " + arguments +
                           " </dev/null >>out 2>>err";
  const pid_t child = fork();
  if (child == 0) {
    if (!prepare()) _exit(kCannotPrepare);
    execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

inline bool set_limit(int resource, std::size_t most) {
  const rlimit limit{most, most};
  return setrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0;
}

// Rights of files bind root as well.
inline bool obey_rights() {
  if (geteuid() != 0) return true;
  return prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE) == 0 &&
         prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH) == 0;
}

// Limits on threads do not bind root: somebody who has no others takes its place.
inline bool limit_threads(std::size_t most) {
  constexpr uid_t kFirst = 20000, kCount = 40000;
  const uid_t nobody_else = kFirst + static_cast<uid_t>(getpid()) % kCount;
  if (geteuid() == 0 && (setgid(nobody_else) != 0 || setuid(nobody_else) != 0)) return false;
  return set_limit(RLIMIT_NPROC, most);
}

}  // namespace halflight::test
