#include "halflight/view/live_scene.h"

#include <algorithm>
#include <tuple>

#include <glm/matrix.hpp>

#include "halflight/hierarchy/live_sides.h"
#include "halflight/rays/automatic_view.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/solve/mix.h"

namespace halflight {
namespace {

using LiveSides = IdVector<SideId, std::uint8_t>;

// One primitive instance, whatever else the scene holds.
using PlacedKey = std::tuple<NodeId, std::uint32_t, std::uint32_t>;
std::map<PlacedKey, IdRange<TriangleId>> placed_triangles(const Geometry& g) {
  std::map<PlacedKey, IdRange<TriangleId>> placed;
  for (const PrimitiveInstance& p : g.primitive_instances)
    placed[{p.node, p.copy, p.primitive}] = p.triangles;
  return placed;
}

bool is_below(const Scene& scene, NodeId node, const std::vector<NodeId>& tops) {
  for (; node.valid(); node = scene.nodes[node].parent)
    if (std::find(tops.begin(), tops.end(), node) != tops.end()) return true;
  return false;
}

LiveSides carry_over(const SolverState& before, const World& world, const Surfaces& surfaces,
                     const std::vector<NodeId>& moved) {
  const auto stood = placed_triangles(before.world->geometry);
  LiveSides live(2 * surfaces.surfaces.size(), 0);
  for (const PrimitiveInstance& p : world.geometry.primitive_instances) {
    const auto there = stood.find({p.node, p.copy, p.primitive});
    const bool known = there != stood.end() && there->second.size() == p.triangles.size() &&
                       !is_below(world.scene, p.node, moved);
    for (std::uint32_t k = 0; k < p.triangles.size(); ++k) {
      const SurfaceId now = surfaces.of_triangle[p.triangles[k]];
      for (const bool back : {false, true}) {
        std::uint8_t& is_live = live[side_of(now, back)];
        if (!known) {
          is_live = 1;
          continue;
        }
        const SurfaceId then = before.surfaces->of_triangle[there->second[k]];
        if (before.tree.side_root(side_of(then, back)).valid()) is_live = 1;
      }
    }
  }
  return live;
}

LiveSides live_sides_of(const SolverState& state) {
  LiveSides live(2 * state.surfaces->surfaces.size(), 0);
  for (std::size_t i = 0; i < live.size(); ++i)
    live[SideId(i)] = state.tree.side_root(SideId(i)).valid() ? 1 : 0;
  return live;
}

void make_live_state(LiveScene& live, const std::shared_ptr<const Surfaces>& surfaces,
                     const LiveSides& sides, bool same_feature_size = false) {
  SolveOptions options = live.options;
  // What a pilot has found out about this scene still holds after a move.
  if (same_feature_size && options.visibility == VisibilityMode::multires &&
      options.visibility_pilot && live.state->fine_parts_made &&
      live.state->visibility->mode() == VisibilityMode::exact)
    options.visibility = VisibilityMode::exact;
  live.state.emplace(make_state(live.world, surfaces, sides, options, Beginning::coarse));
  if (live.groups.empty()) return;
  set_groups(*live.state, live.groups);
  if (live.dimmed()) shine(*live.state, live.factors);
}

Mat4 transform_above(const Scene& scene, const IdVector<NodeId, Mat4>& global, NodeId node) {
  const NodeId parent = scene.nodes[node].parent;
  return parent.valid() ? scene.to_world * global[parent] : scene.to_world;
}

PlacedCamera choose_first_view(const World& world) {
  const auto& cameras = world.geometry.cameras;
  const auto first = std::ranges::find_if(cameras, can_look);
  if (first != cameras.end()) return *first;
  if (!world.geometry.triangles.empty()) return automatic_view(PathTracer(world));
  return {};
}

}  // namespace

bool LiveScene::dimmed() const {
  return std::any_of(factors.begin(), factors.end(), [](const Rgb& f) { return f != Rgb(1.f); });
}

bool can_move(const Scene& scene, NodeId node) {
  constexpr double kMostOff = 1e-6;
  const Mat4 above = transform_above(scene, global_transforms(scene), node);
  const Mat4 off = glm::inverse(above) * above - Mat4(1.0);
  for (int column = 0; column < 4; ++column)
    if (!glm::all(glm::lessThan(glm::abs(off[column]), glm::dvec4(kMostOff)))) return false;
  return true;
}

Scene edited(Scene scene, const std::map<NodeId, SceneEdit>& edits) {
  const auto global = global_transforms(scene);
  for (const auto& [id, edit] : edits) {
    Node& node = scene.nodes[id];
    const Mat4 above = transform_above(scene, global, id);
    Mat4 move(1.0);
    move[3] = glm::dvec4(glm::dvec3(edit.offset), 1.0);
    if (edit.offset != Vec3(0.f)) node.local = glm::inverse(above) * move * above * node.local;
    if (!edit.shown) {
      node.mesh = MeshId();
      node.light = LightId();
    }
  }
  return scene;
}

void enter(LiveScene& live, Scene scene) {
  live.base = scene;
  live.world = make_world(std::move(scene));
  if (auto groups = find_light_groups(live.base)) live.groups = std::move(*groups);
  live.factors.assign(live.groups.size(), Rgb(1.f));
  live.first_view = choose_first_view(*live.world);
}

void begin(LiveScene& live) {
  const auto surfaces = std::make_shared<const Surfaces>(build_surfaces(live.world->geometry));
  make_live_state(
      live, surfaces,
      find_live_sides(live.world->scene, live.world->geometry, *surfaces, live.world->rays));
}

void follow_edits(LiveScene& live, const std::vector<NodeId>& moved) {
  live.world = make_world(edited(live.base, live.edits));
  const auto surfaces = std::make_shared<const Surfaces>(build_surfaces(live.world->geometry));
  const LiveSides sides = carry_over(*live.state, *live.world, *surfaces, moved);
  make_live_state(live, surfaces, sides, true);
}

void restart(LiveScene& live) {
  const auto surfaces = live.state->surfaces;
  const LiveSides sides = live_sides_of(*live.state);
  make_live_state(live, surfaces, sides);
}

bool dim(LiveScene& live, std::vector<Rgb> factors) {
  SolverState& state = *live.state;
  bool awakened = false;
  for (std::size_t g = 0; g < factors.size(); ++g)
    awakened |= live.factors[g] == Rgb(0.f) && factors[g] != Rgb(0.f);
  live.factors = std::move(factors);
  if (state.grouped.separated()) {
    mix(state, live.factors);
    relight(state, live.factors);
    return false;
  }
  if (awakened) {
    restart(live);
    return true;
  }
  shine(state, live.factors);
  return false;
}

}  // namespace halflight
