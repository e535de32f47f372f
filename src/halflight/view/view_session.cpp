#include "halflight/view/view_session.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <future>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "halflight/solve/importance.h"
#include "halflight/solve/mix.h"
#include "halflight/view/loopback_server.h"
#include "halflight/view/packet.h"

namespace halflight {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostWaiting = 64;  // in the inbox
// Iterations: the first is as short as can be, later ones may be longer, as long as a click need
// not wait for them.
constexpr double kFirstIteration = 0.02, kShortest = 0.05, kLongest = 0.3;
constexpr double kShareOfElapsed = 0.1;
// Publishing a frame may take this share of the time. Frames get rarer as less changes from one to
// the next: a page without a graphics card needs the solver's cores to draw each.
constexpr double kPublishingShare = 0.25, kPublishAtLeast = 0.05, kPublishAtMost = 1.0;
constexpr double kPublishingGrowth = 0.1;         // of the interval, by the seconds solved
constexpr std::size_t kEvenVertices = 60'000;     // of the first mesh, beside those of the scene
constexpr std::size_t kMostVertices = 6'000'000;  // that a page is asked to hold
constexpr std::size_t kWholeAtOnce = 300'000;     // triangles of a scene
constexpr std::size_t kFirstTriangles = 100'000;
constexpr std::size_t kMostSharpened = 700'000;  // vertices of the first mesh
// The sharp mesh is drawn many times a second, perhaps without a graphics card: coarser than the
// one that `solve -o` writes.
constexpr std::size_t kSharpVertices = 300'000;
constexpr float kSharpTolerance = 0.1f;
constexpr std::size_t kMostGroupsApart = 8;
constexpr double kQuietBeforeSharpening = 0.3;  // seconds without a change
constexpr std::size_t kMostHistory = 4000;
// While the page asks for the processor, work goes on for this share of the time, in small
// portions.
constexpr auto kGiveWay = std::chrono::milliseconds(400);
constexpr int kNapsPerWork = 6;
constexpr std::size_t kPortion = 1024;  // readings

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

tl::unexpected<Error> has_ended() { return system_error("the live view has ended", "live view"); }

}  // namespace

const char* ViewSession::name_of(Phase phase) {
  switch (phase) {
    case Phase::loading:
      return "loading";
    case Phase::building:
      return "building";
    case Phase::solving:
      return "solving";
    case Phase::paused:
      return "paused";
    case Phase::limited:
      return "limited";
    case Phase::sharpening:
      return "sharpening";
    case Phase::done:
      return "done";
    case Phase::failed:
      break;
  }
  return "failed";
}

ViewSession::ViewSession(Loader load, ViewPlan plan)
    : load_(std::move(load)), plan_(std::move(plan)), id_(random_token()) {
  publish_status();
  thread_ = std::thread([this] { run(); });
}

ViewSession::~ViewSession() {
  stop();
  thread_.join();
}

void ViewSession::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    if (solving_progress_) solving_progress_->cancel();
  }
  copying_progress_.cancel();
  changed_.notify_all();
}

std::string ViewSession::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::optional<std::string> ViewSession::wait_status(std::uint64_t& seen, double seconds) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                    [&] { return stop_ || status_number_ != seen; });
  if (stop_ || status_number_ == seen) return std::nullopt;
  seen = status_number_;
  return status_;
}

std::shared_ptr<const std::string> ViewSession::topology() const {
  const std::lock_guard lock(mutex_);
  return topology_;
}

std::shared_ptr<const World> ViewSession::world() const {
  const std::lock_guard lock(mutex_);
  return world_;
}

std::optional<Error> ViewSession::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::string ViewSession::history(std::size_t first) const {
  json records = json::array();
  const std::lock_guard lock(mutex_);
  for (std::size_t i = first; i < history_.size(); ++i) {
    const IterationRecord& r = history_[i];
    records.push_back({{"stage", halflight::name_of(r.stage)},
                       {"threshold", r.irradiance_threshold},
                       {"links", r.links},
                       {"elements", r.elements},
                       {"rays", r.rays},
                       {"sweeps", r.sweeps},
                       {"predicted", r.predicted_seconds},
                       {"seconds", r.seconds()}});
  }
  return json_text({{"first", first}, {"records", std::move(records)}});
}

Result<void> ViewSession::post(Task task, bool hurry) {
  {
    const std::lock_guard lock(mutex_);
    if (failure_) return tl::unexpected(*failure_);
    if (stop_) return has_ended();
    if (inbox_.size() >= kMostWaiting)
      return system_error("too many requests are waiting", "live view", "wait a moment");
    inbox_.push_back(std::move(task));
    if (hurry && solving_progress_) solving_progress_->cancel();
  }
  changed_.notify_all();
  return {};
}

Result<void> ViewSession::check(const ViewCommand& command) const {
  const auto there = world();
  if (!there) return input_error("the scene is not there yet", "live view", "wait a moment");
  if (command.node.valid() && !there->scene.nodes.contains(command.node))
    return input_error("there is no such node", "live view", "reload the page");
  if (command.offset && !can_move(there->scene, command.node))
    return input_error("this object cannot be moved: what it belongs to has no size along an axis",
                       "live view", "move an object above it");
  return {};
}

Result<void> ViewSession::command(ViewCommand command) {
  if (auto ok = check(command); !ok) return ok;
  if (command.give_way) {
    give_way_until_ = (Clock::now() + kGiveWay).time_since_epoch().count();
    return {};
  }
  // What begins anew has no use for the iteration that runs.
  const bool hurry = command.offset || command.shown || command.feature_size || command.visibility;
  return post({[this, command = std::move(command)] { apply(command); }, true}, hurry);
}

// Leaves the processor alone after work that began at `start`, for as long as the page asks for it.
void ViewSession::nap_after(Clock::time_point start, const std::function<bool()>& wake) {
  const Clock::time_point now = Clock::now(), end = now + kNapsPerWork * (now - start);
  const auto until = [&] {
    return std::min(end, Clock::time_point(Clock::duration(give_way_until_.load())));
  };
  std::unique_lock lock(mutex_);
  bool awake = stop_;
  while (!awake && Clock::now() < until())
    awake = changed_.wait_until(lock, until(), [&] { return stop_ || wake(); });
}

Result<std::string> ViewSession::ask(Question question, double seconds) {
  auto answer = std::make_shared<std::promise<Result<std::string>>>();
  std::future<Result<std::string>> future = answer->get_future();
  // Holds the promise alone: it is broken, and the wait over, where the question is dropped.
  auto run = [this, answer = std::move(answer), question = std::move(question)] {
    if (!even_) {
      answer->set_value(input_error("the scene is not there yet", "live view", "wait a moment"));
      return;
    }
    LiveSolution solution{live_, shown().mesh, shown().draft, sharp_.get()};
    answer->set_value(question(solution));
  };
  if (auto posted = post({std::move(run), false}, false); !posted)
    return tl::unexpected(posted.error());
  if (future.wait_for(std::chrono::duration<double>(seconds)) != std::future_status::ready)
    return system_error("the solver is busy", "live view", "try again in a moment");
  try {
    return future.get();
  } catch (const std::future_error&) {
    if (const auto failed = failure()) return tl::unexpected(*failed);
    return has_ended();
  }
}

Result<std::string> ViewSession::ask_copy(const LongQuestion& question, double seconds) {
  const std::unique_lock one_at_a_time(copying_, std::chrono::duration<double>(seconds));
  if (!one_at_a_time)
    return system_error("other files are being made", "live view", "try again in a moment");
  auto copy = std::make_shared<std::optional<SolutionCopy>>();
  const auto take = [this, copy](LiveSolution& live) -> Result<std::string> {
    copy->emplace(SolutionCopy{*live.scene.state, sharp_});
    return std::string();
  };
  if (auto taken = ask(take, seconds); !taken) return taken;
  auto answer = question(**copy, copying_progress_);
  if (copying_progress_.cancelled()) return has_ended();
  return answer;
}

// The solver's thread from here on.

void ViewSession::run() {
  try {
    if (start()) work();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    failure_ = Error{"there is not enough memory for this scene", "live view",
                     "give a larger --feature-size, or light it with halflight solve --memory",
                     Error::Kind::system};
  }
  stop_sharpening();
  {
    const std::lock_guard lock(mutex_);
    if (failure_) phase_ = Phase::failed;
    inbox_.clear();
  }
  publish_status();
}

bool ViewSession::start() {
  Result<Scene> scene = load_();
  if (!scene) {
    const std::lock_guard lock(mutex_);
    failure_ = scene.error();
    return false;
  }
  set_phase(Phase::building);
  live_.options = plan_.options;
  enter(live_, std::move(*scene));
  const Geometry& g = live_.world->geometry;
  if (g.triangles.empty() || 3 * g.triangles.size() > 2 * kMostVertices) {
    const std::lock_guard lock(mutex_);
    failure_ =
        g.triangles.empty()
            ? Error{"the scene has no triangles", "live view",
                    "check what the file holds with halflight inspect", Error::Kind::input}
            : Error{fmt::format("{} triangles are more than a page can show", g.triangles.size()),
                    "live view", "light it with halflight solve and halflight render",
                    Error::Kind::input};
    return false;
  }
  if (plan_.complete)
    if (auto ok = plan_.complete(live_.options, *live_.world); !ok) {
      const std::lock_guard lock(mutex_);
      failure_ = ok.error();
      return false;
    }
  begin(live_);
  {
    const std::lock_guard lock(mutex_);
    world_ = live_.world;
    if (live_.groups.empty()) {
      sentence_ = "Nothing in this scene gives light.";
      remedy_ = "Start it with --sky 1,1,1, or give a material emission.";
    }
  }
  cut_anew();
  return true;
}

void ViewSession::work() {
  for (;;) {
    while (take_task()) {
    }
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return;
    }
    take_sharpened();
    complete_mesh();
    if (may_advance()) {
      iterate();
      continue;
    }
    if (live_.state->done() && !finished_) finish();
    const bool is_quiet = seconds_since(last_change_) > kQuietBeforeSharpening;
    if (finished_ && !sharpened_ && !sharpening_.joinable() && is_quiet) sharpen();
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(finished_ && !sharpened_ ? 50 : 1000),
                      [&] { return stop_ || !inbox_.empty() || sharpened_ready_; });
  }
}

bool ViewSession::take_task() {
  Task task;
  {
    const std::lock_guard lock(mutex_);
    if (stop_ || inbox_.empty()) return false;
    task = std::move(inbox_.front());
    inbox_.pop_front();
  }
  if (task.changes) stop_sharpening();
  task.run();
  return true;
}

bool ViewSession::may_advance() const {
  if (live_.state->done()) return false;
  if (live_.state->history.empty() || step_) return true;  // there always is some light
  return !paused_ && solving_seconds_ < plan_.seconds &&
         (plan_.links == 0 || live_.state->link_total() < plan_.links);
}

void ViewSession::iterate() {
  SolverState& state = *live_.state;
  const bool first = state.history.empty();
  IterationBudget budget;
  budget.seconds =
      first ? kFirstIteration : std::clamp(kShareOfElapsed * solving_seconds_, kShortest, kLongest);
  budget.seconds = std::max(budget.seconds, 2.0 * least_iteration_seconds(state));
  const auto progress = std::make_shared<Progress>();
  {
    const std::lock_guard lock(mutex_);
    solving_progress_ = progress;
  }
  const auto start = Clock::now();
  advance(state, *progress, budget);
  solving_seconds_ += seconds_since(start);
  step_ = false;
  {
    const std::lock_guard lock(mutex_);
    solving_progress_.reset();
    if (history_.size() < kMostHistory) history_.push_back(state.history.back());
    phase_ = Phase::solving;
    share_ = state.done() ? 1.0 : 0.0;
  }
  const double waited = seconds_since(last_publication_);
  const double interval =
      std::max(std::clamp(kPublishingGrowth * solving_seconds_, kPublishAtLeast, kPublishAtMost),
               publishing_seconds_ / kPublishingShare);
  const bool idle_next = !may_advance();
  if (frames_since_restart_ < 2 || idle_next || waited > interval) publish_light();
  if (idle_next && !state.done()) set_phase(paused_ ? Phase::paused : Phase::limited);
  publish_status();
  nap_after(start, [this] { return !inbox_.empty(); });
}

// The solution is there: lamps are taken apart, so that dimming them takes no solve.
void ViewSession::finish() {
  SolverState& state = *live_.state;
  if (!live_.groups.empty() && live_.groups.size() <= kMostGroupsApart &&
      !state.grouped.separated()) {
    separate(state, Progress());
    if (live_.dimmed()) {
      mix(state, live_.factors);
      relight(state, live_.factors);
    }
  }
  finished_ = true;
  publish_light();
  last_change_ = Clock::now() - std::chrono::seconds(1);
}

void ViewSession::light_changed() {
  finished_ = live_.state->done();
  sharpened_ = false;
  sharp_.reset();
  error_.reset();
  last_change_ = Clock::now();
  // What was done is done no more, before anybody is told of the change.
  const std::lock_guard lock(mutex_);
  phase_ = finished_ ? Phase::sharpening : Phase::solving;
}

// By the user, or else by the pilot.
VisibilityMode ViewSession::visibility_chosen() const {
  return live_.options.visibility_pilot ? live_.state->visibility->mode()
                                        : live_.options.visibility;
}

void ViewSession::apply(const ViewCommand& command) {
  const auto restarted = [this] {
    light_changed();
    finished_ = false;
    solving_seconds_ = 0.0;
    frames_since_restart_ = 0;
    const std::lock_guard lock(mutex_);
    history_.clear();
    world_ = live_.world;
  };
  if (command.paused) paused_ = *command.paused;
  if (command.step) step_ = true;
  if (command.seconds) plan_.seconds = *command.seconds;
  if (command.links) plan_.links = *command.links;

  bool again = false;
  SolveOptions& options = live_.options;
  if (command.feature_size && *command.feature_size != options.feature_size) {
    options.feature_size = *command.feature_size;
    again = true;
  }
  if (command.visibility) {
    again |= *command.visibility != visibility_chosen();
    options.visibility = *command.visibility;
    options.visibility_pilot = false;  // the user has chosen
  }
  bool finer = false;
  if (command.error && *command.error != options.error) {
    finer = *command.error < options.error && live_.state->done();
    again |= !finer;
    options.error = *command.error;
  }
  if (command.important || command.all_important) {
    options.importance = command.important;
    live_.state->options.importance = command.important;
    live_.state->seen.clear();
    live_.state->importance.clear();
    if (command.important) {
      live_.state->seen = seen_surfaces(*live_.state->world, *command.important);
      finer |= live_.state->done();
    }
  }

  if (command.offset || command.shown) {
    SceneEdit& edit = live_.edits[command.node];
    const Vec3 by = command.offset ? *command.offset - edit.offset : Vec3(0.f);
    const bool same_triangles = !command.shown || *command.shown == edit.shown;
    edit.offset += by;
    if (command.shown) edit.shown = *command.shown;
    if (same_triangles) {
      // The object is seen at its new place at once, in the light that it had.
      set_phase(Phase::solving);
      const bool had_light = !live_.state->history.empty();
      const std::vector<Rgb> light = even_->draft.read(*live_.state).irradiance;
      sharp_shown_.reset();
      translate(even_->mesh, *live_.world, command.node, by);
      show(*even_);
      if (had_light) frames_.add(epoch_, light, exposure_);
      publish_status();
      const auto before = live_.world;
      follow_edits(live_, {command.node});
      // Triangles may have lost their area in single precision, or got one.
      if (std::ranges::equal(before->geometry.triangles, live_.world->geometry.triangles))
        even_->draft.restart(*live_.world);
      else
        cut_anew();
    } else {
      follow_edits(live_, {command.node});
      cut_anew();
    }
    restarted();
  } else if (again) {
    const float before = live_.state->options.feature_size;
    restart(live_);
    restarted();
    restart_drafts();
    if (live_.state->options.feature_size != before) {
      cut_anew();
    } else if (sharp_shown_) {
      sharp_shown_.reset();
      show(*even_);
    }
  } else if (finer) {
    constexpr float kFinerWhereSeen = 2.f;
    const float by = command.error ? live_.state->options.error / options.error : kFinerWhereSeen;
    aim_finer(*live_.state, std::max(1.01f, by));
    // Cells and links will change: what is known of each lamp alone no longer holds.
    live_.state->grouped.light.clear();
    live_.state->grouped.exitance.clear();
    light_changed();
    finished_ = false;
  }

  if (!command.groups.empty()) {
    std::vector<Rgb> factors = live_.factors;
    for (const auto& [name, factor] : command.groups)
      for (std::size_t g = 0; g < factors.size(); ++g)
        if (live_.groups[g].name == name) factors[g] = factor;
    if (factors != live_.factors) {
      if (dim(live_, std::move(factors))) {
        restarted();
        restart_drafts();
      }
      light_changed();
      if (!live_.state->history.empty()) publish_light();
    }
  }
  if (!may_advance() && !live_.state->done()) set_phase(paused_ ? Phase::paused : Phase::limited);
  publish_status();
}

// The even mesh; of large scenes its largest triangles first, which are on the page much sooner.
void ViewSession::cut_anew() {
  partial_ = frames_since_restart_ == 0 && live_.world->geometry.triangles.size() > kWholeAtOnce;
  sharp_shown_.reset();
  const LitMesh cut = partial_ ? cut_evenly(*live_.state, kEvenVertices, kFirstTriangles)
                               : cut_evenly(*live_.state, kEvenVertices);
  even_ = std::make_unique<Shown>(*live_.world, make_view_mesh(*live_.world, cut));
  show(*even_);
}

void ViewSession::complete_mesh() {
  if (!partial_ || frames_since_restart_ == 0) return;
  cut_anew();
  publish_light();
}

void ViewSession::show(Shown& shown) {
  shown.mesh.epoch = ++epoch_;
  auto packet = std::make_shared<const std::string>(topology_packet(
      shown.mesh, *live_.world, live_.first_view, live_.state->options.feature_size));
  frames_.begin(epoch_);
  const std::lock_guard lock(mutex_);
  topology_ = std::move(packet);
}

// The state began again.
void ViewSession::restart_drafts() {
  even_->draft.restart(*live_.world);
  if (sharp_shown_) sharp_shown_->draft.restart(*live_.world);
}

void ViewSession::publish_light() {
  const auto start = Clock::now();
  const DraftLight::Frame frame = shown().draft.read(*live_.state);
  exposure_ = frame.exposure;
  frames_.add(epoch_, frame.irradiance, frame.exposure);
  ++frames_since_restart_;
  last_publication_ = Clock::now();
  publishing_seconds_ = seconds_since(start);
  if (first_light_seconds_ == 0.0) first_light_seconds_ = seconds_since(begin_);
  publish_status();
}

void ViewSession::set_phase(Phase phase) {
  {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
  }
  publish_status();
}

void ViewSession::publish_status() {
  json s;
  s["session"] = id_;
  if (live_.state) {
    const SolverState& state = *live_.state;
    s["epoch"] = epoch_;
    s["sharp"] = sharp_shown_ && sharp_;
    s["featureSize"] = state.options.feature_size;
    s["errorWanted"] = live_.options.error;
    s["visibilityWanted"] = halflight::name_of(visibility_chosen());
    s["visibility"] = halflight::name_of(state.visibility->mode());
    s["stage"] = halflight::name_of(state.schedule.stage);
    s["level"] = state.schedule.level;
    s["levels"] = state.options.levels;
    s["receiversLeft"] = state.schedule.receivers.size();
    s["receivers"] = state.schedule.receiver_total;
    s["elements"] = state.tree.size();
    s["clusters"] = state.tree.cluster_total();
    s["links"] = state.link_total();
    s["rays"] = state.world->rays.ray_total();
    s["iterations"] = state.history.size();
    s["meanIrradiance"] = mean_irradiance(state);
    s["solvingSeconds"] = solving_seconds_;
    s["firstLightSeconds"] = first_light_seconds_;
    s["publishingSeconds"] = publishing_seconds_;
    s["cpuSeconds"] = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    s["wallSeconds"] = seconds_since(begin_);
    s["paused"] = paused_;
    s["secondsLimit"] = std::isfinite(plan_.seconds) ? plan_.seconds : 0.0;
    s["linksLimit"] = plan_.links;
    s["important"] = live_.options.importance.has_value();
    s["groups"] = json::array();
    for (std::size_t g = 0; g < live_.groups.size(); ++g) {
      const Rgb& f = live_.factors[g];
      s["groups"].push_back({{"name", live_.groups[g].name}, {"factor", {f.r, f.g, f.b}}});
    }
    s["edits"] = json::array();
    for (const auto& [node, edit] : live_.edits)
      s["edits"].push_back({{"node", node.value},
                            {"offset", {edit.offset.x, edit.offset.y, edit.offset.z}},
                            {"shown", edit.shown}});
    if (error_) s["error"] = {{"estimated", error_->relative_rms}, {"noise", error_->least}};
    const std::vector<std::string>& warnings = state.world->scene.warnings;
    s["warnings"] = std::vector<std::string>(
        warnings.begin(), warnings.begin() + std::min<std::ptrdiff_t>(
                                                 5, static_cast<std::ptrdiff_t>(warnings.size())));
  }
  s["version"] = frames_.version();
  {
    const std::lock_guard lock(mutex_);
    if (failure_) {
      sentence_ =
          failure_->where == "live view" ? failure_->what : failure_->where + ": " + failure_->what;
      remedy_ = failure_->remedy;
    }
    s["phase"] = name_of(phase_);
    s["sentence"] = sentence_;
    s["remedy"] = remedy_;
    s["records"] = history_.size();
    s["number"] = ++status_number_;
    status_ = json_text(s);
  }
  changed_.notify_all();
}

std::vector<Reading> ViewSession::read_in_portions(const SolutionReader& reader,
                                                   std::span<const ReadingPoint> points,
                                                   const Progress& progress) {
  std::vector<Reading> readings;
  readings.reserve(points.size());
  while (!points.empty()) {
    const auto start = Clock::now();
    const auto portion = points.first(std::min(kPortion, points.size()));
    const std::vector<Reading> part = reader(portion, progress);
    readings.insert(readings.end(), part.begin(), part.end());
    points = points.subspan(portion.size());
    nap_after(start, [&progress] { return progress.cancelled(); });
  }
  return readings;
}

// The finished solution, read exactly at the vertices of a mesh that follows the light, and how far
// it is from the truth.
void ViewSession::sharpen() {
  if (shown().mesh.positions.size() > kMostSharpened && !sharp_shown_) {
    sharpened_ = true;
    set_phase(Phase::done);
    return;
  }
  set_phase(Phase::sharpening);
  sharpening_progress_ = std::make_unique<Progress>();
  sharpened_result_ = std::make_unique<Sharpened>();
  sharpening_ = std::thread([this, &state = *live_.state, &progress = *sharpening_progress_,
                             &result = *sharpened_result_] {
    const World& world = *state.world;
    const SolutionReader reader(state, kMeshReading);
    LitMeshOptions options;
    options.feature_size = state.options.feature_size;
    options.finest = finest_mesh_edge(state);
    options.coarse = 8.f * options.feature_size;
    options.tolerance = kSharpTolerance;
    options.simple = simple_edge(state);
    options.max_vertices = std::max(kSharpVertices, 2 * shown().mesh.positions.size());
    LitMesh mesh = build_lit_mesh(
        world.scene, world.geometry, sides_worth_showing(state),
        [&](std::span<const ReadingPoint> points) {
          return read_in_portions(reader, points, progress);
        },
        options, progress);
    if (!progress.cancelled()) result.mesh = std::move(mesh);
    result.error = ErrorProbes(state, progress).measure(state, progress);
    {
      const std::lock_guard lock(mutex_);
      sharpened_ready_ = true;
    }
    changed_.notify_all();
  });
}

void ViewSession::stop_sharpening() {
  if (!sharpening_.joinable()) return;
  sharpening_progress_->cancel();
  changed_.notify_all();
  sharpening_.join();
  const std::lock_guard lock(mutex_);
  sharpened_ready_ = false;
}

void ViewSession::take_sharpened() {
  {
    const std::lock_guard lock(mutex_);
    if (!sharpened_ready_) return;
    sharpened_ready_ = false;
  }
  sharpening_.join();
  sharpened_ = true;
  error_ = sharpened_result_->error;
  if (sharpened_result_->mesh) {
    sharp_ = std::make_shared<const LitMesh>(std::move(*sharpened_result_->mesh));
    ViewMesh mesh = make_view_mesh(*live_.world, *sharp_);
    mesh.sharp = true;
    sharp_shown_ = std::make_unique<Shown>(*live_.world, std::move(mesh));
    show(*sharp_shown_);
    frames_.add(epoch_, vertex_light(*sharp_), exposure_);
  }
  set_phase(Phase::done);
}

}  // namespace halflight
