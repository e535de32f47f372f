#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "commands.h"
#include "halflight/base/one_line.h"
#include "halflight/base/parallel.h"

namespace halflight::app {
namespace {

int run(int argc, char** argv) {
  CLI::App cli{"Lights diffuse 3-D scenes without noise.", "halflight"};
  cli.set_version_flag("--version", HALFLIGHT_VERSION);
  cli.require_subcommand(1);
  cli.failure_message([](const CLI::App*, const CLI::Error& e) {
    return "halflight: " + one_line(e.what()) + " (--help lists what there is)\n";
  });
  int status = kGoalMet;
  add_solve(cli, status);
  add_sample(cli, status);
  add_mix(cli, status);
  add_render(cli, status);
  add_view(cli, status);
  add_inspect(cli, status);
  add_scene(cli, status);
  add_reference(cli, status);
  add_compare(cli, status);
  add_reproduce(cli, status);
  set_thread_count(0);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return cli.exit(e) == 0 ? kGoalMet : kBadInput;
  }
  return status;
}

// What is thrown when the machine has no more to give. Makes no strings: there may be no memory.
int fail(const std::exception& e) {
  const bool memory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
  const bool machine = dynamic_cast<const std::runtime_error*>(&e) != nullptr;
  std::fprintf(stderr, "halflight: %s (%s)\n", memory ? "there is not enough memory" : e.what(),
               memory    ? "light more coarsely, with a larger --feature-size, or lift the limit"
               : machine ? "lift the limits on memory and threads, or give --threads 1"
                         : "please report it");
  return kSystemFailure;
}

// The same from where nothing may be thrown, as inside oneTBB. Anything else is a bug, and aborts.
[[noreturn]] void on_terminate() {
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::logic_error& e) {
    std::fprintf(stderr, "halflight: internal error: %s (please report it)\n", e.what());
  } catch (const std::exception& e) {
    std::_Exit(fail(e));
  }
  std::abort();
}

int flush_output(int status) {
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (written || status == kSystemFailure) return status;  // which has been told
  std::fputs("halflight: the standard output cannot be written to (check that there is room)\n",
             stderr);
  return kSystemFailure;
}

}  // namespace

int fail(const Error& error) {
  std::fprintf(stderr, "halflight: %s\n", error.line().c_str());
  return error.kind == Error::Kind::input ? kBadInput : kSystemFailure;
}

void warn(const std::string& text) {
  std::fputs(("halflight: warning: " + text + "\n").c_str(), stderr);
}

void also(Result<void>& written, const Result<void>& next) {
  if (!written && !next) warn(next.error().line());
  if (written) written = next;
}

}  // namespace halflight::app

int main(int argc, char** argv) {
  using namespace halflight::app;
  std::set_terminate(on_terminate);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of writing
  int status = kGoalMet;
  try {
    status = run(argc, argv);
  } catch (const std::logic_error&) {
    throw;
  } catch (const std::exception& e) {
    status = fail(e);
  }
  return flush_output(status);
}
