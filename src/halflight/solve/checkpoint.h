// Checkpoints: the state of a solve in a file, to go on from, or to read the light from later.
// World, surfaces, hierarchy and visibility are made anew from the scene; what light has brought
// about (cells, light, links, history) comes from the file.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "halflight/base/result.h"
#include "halflight/io/checkpoint_file.h"
#include "halflight/io/load_scene.h"
#include "halflight/solve/solver.h"

namespace halflight {

// Where a scene was read from, and how.
struct SceneSource {
  std::filesystem::path path;
  LoadOptions load;
  Rgb sky{0.f};
};

// What a solve is of.
struct SolveOrigin {
  SceneSource scene;
  std::uint64_t scene_digest = 0;
  SolveOptions options;  // resolved, as asked for; the state's own may aim at less error by now
};

// The scene's path is stored as seen from the checkpoint's folder: both can move together.
Result<void> write_checkpoint(const std::filesystem::path& path, const SolveOrigin& origin,
                              const SolverState& state);

class Checkpoint {
 public:
  // Errors of all of these name the file, what is wrong with it and the remedy.
  static Result<Checkpoint> open(const std::filesystem::path& path);
  // The same of a file that was read already; the scene is looked for as seen from `path`.
  static Result<Checkpoint> parse(Bytes bytes, const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const SolveOrigin& origin() const { return origin_; }

  // The scene that was solved, from another place when `instead` is not empty; an error when it is
  // gone or has changed.
  Result<Scene> load_scene(const std::filesystem::path& instead = {}) const;
  // Whether this solve may go on from here.
  Result<void> check(const SolveOrigin& wanted) const;
  // The state as it was, over the world made from its scene.
  Result<SolverState> restore(const std::shared_ptr<const World>& world) const;

 private:
  std::filesystem::path path_;
  SectionReader sections_;
  SolveOrigin origin_;
  SolveOptions options_;
};

// Keeps a file up to date while a solve goes on.
class CheckpointKeeper {
 public:
  CheckpointKeeper(std::filesystem::path path, SolveOrigin origin)
      : path_(std::move(path)), origin_(std::move(origin)) {}

  const std::filesystem::path& path() const { return path_; }

  // Nothing happens when the same state was written before.
  Result<void> save(const SolverState& state);
  // Only when a while has passed, so that writing takes but a small share of the time.
  Result<void> save_if_due(const SolverState& state);

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path path_;
  SolveOrigin origin_;
  std::optional<std::pair<std::size_t, bool>> saved_;  // iterations, and whether groups are apart
  Clock::time_point due_ = Clock::now();
};

}  // namespace halflight
