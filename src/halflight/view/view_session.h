// A live view without its web server: a thread that loads, solves in short iterations, publishes
// the light after them, and in between does what it is asked to.
//
//   solver's thread    owns LiveScene; commands and questions reach it through an inbox
//   sharpening thread  reads the finished solution at a mesh that follows the light; only looks
//   any other thread   status, topology and light frames: shared, immutable, swapped whole
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/base/result.h"
#include "halflight/output/estimated_error.h"
#include "halflight/output/read_light.h"
#include "halflight/view/draft_light.h"
#include "halflight/view/light_frames.h"
#include "halflight/view/live_scene.h"
#include "halflight/view/view_command.h"

namespace halflight {

struct ViewPlan {
  SolveOptions options;
  // Adds what needs the scene, as views and rules by name; may be empty.
  std::function<Result<void>(SolveOptions&, const World&)> complete;
  double seconds = std::numeric_limits<double>::infinity();  // of solving
  std::size_t links = 0;                                     // most; 0: no limit
};

// What questions may look at, on the solver's thread.
struct LiveSolution {
  LiveScene& scene;
  const ViewMesh& mesh;
  DraftLight& draft;
  const LitMesh* sharp;  // null: not there, or of other light
};

// A copy of a solution, for what takes long to look at: the solver goes on meanwhile.
struct SolutionCopy {
  SolverState state;
  std::shared_ptr<const LitMesh> sharp;  // as in LiveSolution
};

class ViewSession {
 public:
  using Loader = std::function<Result<Scene>()>;
  // Null: the answer is an error line for the page.
  using Question = std::function<Result<std::string>(LiveSolution&)>;

  ViewSession(Loader load, ViewPlan plan);
  ~ViewSession();
  ViewSession(const ViewSession&) = delete;
  ViewSession& operator=(const ViewSession&) = delete;

  // JSON. `wait_status` returns at once when the one that was seen is old, else within `seconds`.
  std::string status() const;
  std::optional<std::string> wait_status(std::uint64_t& seen, double seconds) const;
  std::shared_ptr<const std::string> topology() const;  // null: not there yet
  const LightFrames& frames() const { return frames_; }
  std::shared_ptr<const World> world() const;  // null: not there yet
  std::string history(std::size_t first) const;
  // Why there is nothing to see.
  std::optional<Error> failure() const;

  Result<void> command(ViewCommand command);
  // Waits for the answer; an error when it takes longer than `seconds`.
  Result<std::string> ask(Question question, double seconds);
  // The same for what takes long: works on a copy, on the thread that asks, one at a time. An error
  // when it has to wait for its turn, or for the copy, longer than `seconds`.
  using LongQuestion = std::function<Result<std::string>(const SolutionCopy&, const Progress&)>;
  Result<std::string> ask_copy(const LongQuestion& question, double seconds);

  // Ends all work soon, also that of questions; they are answered by errors from here on.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Phase { loading, building, solving, paused, limited, sharpening, done, failed };
  struct Task {
    std::function<void()> run;
    bool changes = false;  // the solution: sharpening has to stop first
  };
  // What is drawn, and how its light is read.
  struct Shown {
    Shown(const World& world, ViewMesh view_mesh)
        : mesh(std::move(view_mesh)), draft(world, mesh) {}
    Shown(const Shown&) = delete;
    Shown& operator=(const Shown&) = delete;
    ViewMesh mesh;
    DraftLight draft;
  };
  struct Sharpened {
    std::optional<EstimatedError> error;
    std::optional<LitMesh> mesh;
  };
  static const char* name_of(Phase phase);

  Result<void> post(Task task, bool hurry);
  void nap_after(Clock::time_point start, const std::function<bool()>& wake);
  void run();
  bool start();
  void work();
  bool take_task();
  bool may_advance() const;
  void iterate();
  void finish();
  void apply(const ViewCommand& command);
  Result<void> check(const ViewCommand& command) const;
  VisibilityMode visibility_chosen() const;

  Shown& shown() { return sharp_shown_ ? *sharp_shown_ : *even_; }
  void cut_anew();
  void complete_mesh();
  void show(Shown& shown);
  void restart_drafts();
  void publish_light();
  void publish_status();
  void set_phase(Phase phase);
  void light_changed();

  void sharpen();
  std::vector<Reading> read_in_portions(const SolutionReader& reader,
                                        std::span<const ReadingPoint> points,
                                        const Progress& progress);
  void stop_sharpening();
  void take_sharpened();

  Loader load_;
  ViewPlan plan_;
  LightFrames frames_;

  // The solver's thread alone.
  LiveScene live_;
  std::unique_ptr<Shown> even_;           // drawn until there is a sharp one
  std::unique_ptr<Shown> sharp_shown_;    // takes its place
  bool partial_ = false;                  // the even mesh is not whole yet
  std::uint32_t epoch_ = 0;               // of the mesh that is drawn
  std::shared_ptr<const LitMesh> sharp_;  // null: not there, or of other light
  std::optional<EstimatedError> error_;
  float exposure_ = 1.f;
  bool paused_ = false, step_ = false, finished_ = false, sharpened_ = false;
  std::size_t frames_since_restart_ = 0;
  double solving_seconds_ = 0.0, publishing_seconds_ = 0.0;
  Clock::time_point last_publication_, last_change_;
  Clock::time_point begin_ = Clock::now();
  double first_light_seconds_ = 0.0;

  std::thread sharpening_;
  std::unique_ptr<Progress> sharpening_progress_;
  std::unique_ptr<Sharpened> sharpened_result_;

  std::timed_mutex copying_;                   // held while somebody looks at a copy
  Progress copying_progress_;                  // cancelled at the end
  std::atomic<Clock::rep> give_way_until_{0};  // ticks of the clock

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::deque<Task> inbox_;
  bool stop_ = false;
  bool sharpened_ready_ = false;
  Phase phase_ = Phase::loading;
  std::string sentence_, remedy_;
  double share_ = 0.0;
  std::uint64_t status_number_ = 0;
  std::string status_ = "{}";
  std::shared_ptr<const std::string> topology_;
  std::shared_ptr<const World> world_;
  std::vector<IterationRecord> history_;
  std::optional<Error> failure_;
  std::shared_ptr<Progress> solving_progress_;  // cancelled by what makes the iteration worthless
  std::string id_;

  std::thread thread_;
};

}  // namespace halflight
