#include "solve_arguments.h"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "halflight/base/quantities.h"
#include "halflight/io/feature_size_rules.h"
#include "halflight/output/choose_view.h"
#include "halflight/rays/automatic_view.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/solve/settings.h"
#include "number_checks.h"
#include "terminal_progress.h"

namespace halflight::app {
namespace {

constexpr double kLongestTime = 1e8;  // seconds; three years

}  // namespace

void add_solve_arguments(CLI::App& command, SolveArguments& arguments) {
  add_visibility_arguments(command, arguments.visibility, "multires");
  command
      .add_option(
          "--error", arguments.error,
          "relative RMS error of irradiance to measure and to stop at; without it about 5%, "
          "not measured")
      ->type_name("PCT");
  command.add_option("--time", arguments.time, "stop refining at this wall time, e.g. 10s")
      ->type_name("DUR");
  command
      .add_option("--memory", arguments.memory,
                  "stay below this resident size and light more coarsely instead, e.g. 2GiB")
      ->type_name("SIZE");
  command
      .add_option("--links", arguments.links,
                  "refined: by the error oracle alone; sampled: by rays on the elements it shaped; "
                  "auto: what measures best, sampled; N: no more than these")
      ->allow_extra_args(false)  // one for each --links
      ->type_name("auto|refined|sampled|N");
  command
      .add_option("--importance", arguments.importance,
                  "a view (as for render --camera): light only counts for what is seen there")
      ->type_name("VIEW|none")
      ->capture_default_str();
  command
      .add_option("--feature-sizes", arguments.feature_sizes,
                  "feature sizes by material or node, see docs/command-line.md")
      ->check(file_name())
      ->type_name("RULES.toml");
  std::map<std::string, HierarchyKind> hierarchies;
  for (const NamedHierarchy& h : kHierarchies) hierarchies.emplace(h.name, h.kind);
  command.add_option("--hierarchy", arguments.hierarchy, "who groups surfaces into clusters")
      ->transform(CLI::CheckedTransformer(hierarchies).description(""))
      ->type_name("size-grid|kd-tree|goldsmith-salmon|agglomerative")
      ->default_str("size-grid");
  command
      .add_option("--intra-cluster", arguments.intra_cluster,
                  "on: light on a cluster goes to what is seen of it; off: to all that faces it")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"on", true}, {"off", false}})
                      .description(""))
      ->type_name("on|off")
      ->default_str(arguments.intra_cluster ? "on" : "off");
  command.add_option("--progress", arguments.progress, "how to tell of it on standard error")
      ->check(CLI::IsMember({"auto", "json", "none"}).description(""))
      ->type_name("auto|json|none")
      ->capture_default_str();
  add_threads(command, arguments.threads);
}

void add_files(CommandFiles& files, const SolveArguments& arguments) {
  files.reads("the rules", arguments.feature_sizes);
  files.reads_view("the view", arguments.importance);
  if (const auto pixels = pixel_size_wish(arguments.visibility.feature_size); pixels && *pixels)
    files.reads_view("the view", (*pixels)->camera);
}

Result<SolvePlan> resolve(const SolveArguments& arguments) {
  SolvePlan plan;
  plan.options.visibility = arguments.visibility.mode.value_or(VisibilityMode::multires);
  const Result<float> feature_size = resolve_feature_size(arguments.visibility);
  if (!feature_size) return tl::unexpected(feature_size.error());
  plan.options.feature_size = *feature_size;
  plan.options.hierarchy = arguments.hierarchy;
  plan.options.intra_cluster = arguments.intra_cluster;
  if (!arguments.error.empty()) {
    const Result<double> error = parse_percent(arguments.error);
    if (!error) return tl::unexpected(error.error());
    if (!(*error >= double{kLeastError} && *error <= double{kLargestError}))
      return input_error(fmt::format("--error must lie between {:g}% and {:g}%", 100 * kLeastError,
                                     100 * kLargestError),
                         {}, "try 1%");
    plan.options.error = static_cast<float>(*error);
    plan.goals.error = plan.options.error;
  }
  for (const std::string& links : arguments.links) {
    if (links == "auto" || links == "refined" || links == "sampled") {
      plan.options.links = links == "refined" ? LinkMaker::refined : LinkMaker::sampled;
      continue;
    }
    const Result<double> most = parse_count(links);
    if (!most || !(*most >= 1.0))
      return input_error(
          fmt::format("--links '{}' is neither auto, refined, sampled nor a count", links), {},
          "write it like 'sampled' or 250k");
    plan.goals.links = static_cast<std::size_t>(std::min(*most, 1e15));
    plan.options.most_links = std::min(plan.options.most_links, *plan.goals.links);
  }
  if (!arguments.memory.empty()) {
    const Result<double> memory = parse_size(arguments.memory);
    if (!memory || !(*memory >= 1.0))
      return input_error(fmt::format("--memory '{}' is not a size", arguments.memory), {},
                         "write it like 2GiB or 500MB");
    plan.options.memory = static_cast<std::size_t>(std::min(*memory, 1e15));
  }
  if (!arguments.time.empty())
    if (const Result<double> time = parse_duration(arguments.time); !time)
      return tl::unexpected(time.error());
  return plan;
}

namespace {

Result<ViewOfInterest> view_of_interest(const std::string& wish, const World& world) {
  const Result<View> view = choose_view(wish, world.scene, world.geometry,
                                        [&] { return automatic_view(PathTracer(world)); });
  if (!view) return tl::unexpected(view.error());
  const auto [width, height] = picture_size(*view);
  return ViewOfInterest{view->camera, width, height};
}

}  // namespace

Result<void> complete(SolvePlan& plan, const SolveArguments& arguments, const World& world) {
  if (!arguments.feature_sizes.empty()) {
    auto rules = read_feature_size_rules(arguments.feature_sizes);
    if (!rules) return tl::unexpected(rules.error());
    if (auto ok = check_rules(*rules, world, arguments.feature_sizes); !ok) return ok;
    plan.options.feature_size_rules = std::move(*rules);
  }
  const auto pixels = pixel_size_wish(arguments.visibility.feature_size);
  if (!pixels) return tl::unexpected(pixels.error());
  if (*pixels) {
    const Result<ViewOfInterest> view = view_of_interest((*pixels)->camera, world);
    if (!view) return tl::unexpected(view.error());
    plan.options.pixels = PixelFeatureSize{*view, (*pixels)->pixels};
  }
  if (arguments.importance != "none") {
    const Result<ViewOfInterest> view = view_of_interest(arguments.importance, world);
    if (!view) return tl::unexpected(view.error());
    plan.options.importance = *view;
  }
  return {};
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
  Clock::time_point end;
  std::mutex mutex;
  std::condition_variable changed;
  bool finished = false;
  std::thread thread;
};

Deadline::Deadline(Progress& progress, const SolveArguments& arguments, Clock::time_point start) {
  if (arguments.time.empty()) return;
  const std::chrono::duration<double> time(std::min(*parse_duration(arguments.time), kLongestTime));
  timer_ = std::make_unique<Timer>();
  timer_->end = start + std::chrono::duration_cast<Clock::duration>(time);
  timer_->thread = std::thread([&progress, timer = timer_.get()] {
    std::unique_lock lock(timer->mutex);
    if (!timer->changed.wait_until(lock, timer->end, [&] { return timer->finished; }))
      progress.cancel();
  });
}

double Deadline::seconds_left() const {
  return std::chrono::duration<double>(timer_->end - Clock::now()).count();
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
