#include "solve_arguments.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "halflight/base/quantities.h"
#include "terminal_progress.h"

namespace halflight::app {

void add_solve_arguments(CLI::App& command, SolveArguments& arguments) {
  add_visibility_arguments(command, arguments.visibility, "multires");
  command.add_option("--error", arguments.error, "relative RMS error of irradiance to aim at")
      ->type_name("PCT")
      ->capture_default_str();
  command.add_option("--time", arguments.time, "stop refining at this wall time, e.g. 10s")
      ->type_name("DUR");
  const std::map<std::string, LinkMaker> makers{{"refined", LinkMaker::refined},
                                                {"sampled", LinkMaker::sampled}};
  command
      .add_option("--links", arguments.links,
                  "refined: by the error oracle alone; sampled: by rays on the elements it shaped")
      ->transform(CLI::CheckedTransformer(makers).description(""))
      ->type_name("refined|sampled")
      ->default_str("sampled");
  std::map<std::string, HierarchyKind> hierarchies;
  for (const NamedHierarchy& h : kHierarchies) hierarchies.emplace(h.name, h.kind);
  command.add_option("--hierarchy", arguments.hierarchy, "who groups surfaces into clusters")
      ->transform(CLI::CheckedTransformer(hierarchies).description(""))
      ->type_name("size-grid|kd-tree|goldsmith-salmon|agglomerative")
      ->default_str("size-grid");
  command.add_option("--progress", arguments.progress, "how to tell of it on standard error")
      ->check(CLI::IsMember({"auto", "json", "none"}).description(""))
      ->type_name("auto|json|none")
      ->capture_default_str();
  command.add_option("--threads", arguments.threads, "0: all cores")
      ->check(CLI::Range(0, 4096).description(""))
      ->type_name("N")
      ->capture_default_str();
}

Result<SolveOptions> resolve(const SolveArguments& arguments) {
  SolveOptions options;
  options.links = arguments.links;
  options.visibility = arguments.visibility.mode.value_or(VisibilityMode::multires);
  const Result<float> feature_size = resolve_feature_size(arguments.visibility);
  if (!feature_size) return tl::unexpected(feature_size.error());
  options.feature_size = *feature_size;
  options.hierarchy = arguments.hierarchy;
  const Result<double> error = parse_percent(arguments.error);
  if (!error) return tl::unexpected(error.error());
  if (!(*error > 0.0)) return input_error("--error must be above zero", {}, "try 1%");
  options.error = static_cast<float>(*error);
  if (!arguments.time.empty())
    if (const Result<double> time = parse_duration(arguments.time); !time)
      return tl::unexpected(time.error());
  return options;
}

Progress::Listener progress_listener(const SolveArguments& arguments) {
  if (arguments.progress == "none") return {};
  if (arguments.progress == "auto") return terminal_progress();
  return [](std::string_view phase, double share) {
    std::fputs(fmt::format("{{\"phase\":\"{}\",\"share\":{:.4f}}}\n", phase, share).c_str(),
               stderr);
  };
}

struct Deadline::Timer {
  std::mutex mutex;
  std::condition_variable changed;
  bool finished = false;
  std::thread thread;
};

Deadline::Deadline(Progress& progress, const SolveArguments& arguments) {
  if (arguments.time.empty()) return;
  const std::chrono::duration<double> time(*parse_duration(arguments.time));
  timer_ = std::make_unique<Timer>();
  timer_->thread = std::thread([&progress, time, timer = timer_.get()] {
    std::unique_lock lock(timer->mutex);
    if (!timer->changed.wait_for(lock, time, [&] { return timer->finished; })) progress.cancel();
  });
}

Deadline::~Deadline() {
  if (!timer_) return;
  {
    const std::lock_guard lock(timer_->mutex);
    timer_->finished = true;
  }
  timer_->changed.notify_all();
  timer_->thread.join();
}

}  // namespace halflight::app
