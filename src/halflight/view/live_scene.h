// The scene of a live view as it is now: what was read, what the user has changed, and the solver's
// state for it. Whatever a change leaves as it was is taken over.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "halflight/scene/light_groups.h"
#include "halflight/solve/solver.h"

namespace halflight {

struct SceneEdit {
  Vec3 offset{0.f};  // metres
  bool shown = true;
};

struct LiveScene {
  Scene base;  // as it was read
  std::map<NodeId, SceneEdit> edits;
  std::vector<LightGroup> groups;
  std::vector<Rgb> factors;  // by which the groups are multiplied
  SolveOptions options;      // as wished for
  std::shared_ptr<const World> world;
  std::optional<SolverState> state;
  PlacedCamera first_view;

  bool dimmed() const;
};

// Whether a node can be moved in world space: not where a node above leaves it no size along some
// axis.
bool can_move(const Scene& scene, NodeId node);
// The scene with nodes moved in world space, or without what they show.
Scene edited(Scene scene, const std::map<NodeId, SceneEdit>& edits);

// A world for the first time, and a view: a camera of the scene, or one that shows it.
void enter(LiveScene& live, Scene scene);
// Its first state.
void begin(LiveScene& live);
// After edits: the world anew. Which sides can see light is taken over for what stood before;
// everything of a node that was moved counts as seen.
void follow_edits(LiveScene& live, const std::vector<NodeId>& moved);
// After other options: the same world and surfaces, a state that begins again.
void restart(LiveScene& live);

// Multiplies light groups. Takes a moment when their lights are known apart, else as long as direct
// light on all cells does. A lamp that was dark when the links were made needs them made again:
// true when the state began again.
bool dim(LiveScene& live, std::vector<Rgb> factors);

}  // namespace halflight
