// Which sides can see light: none inside closed bodies, all that face a lit room.
#include <gtest/gtest.h>

#include "halflight/hierarchy/live_sides.h"
#include "halflight/rays/world.h"
#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/shapes.h"
#include "quad_scene.h"

namespace halflight {
namespace {

const Bounds3f kRoom{Vec3(0.f), Vec3(4.f, 3.f, 4.f)};
const Bounds3f kCrate{{1, 0.5f, 1}, {2, 1.5f, 2}};

// A room, and in it a closed crate of the given material.
class RoomWithCrate {
 public:
  Scene scene;
  MaterialId wall = add_material(scene, "wall", Rgb(0.7f));
  MaterialId crate = add_material(scene, "crate", Rgb(0.5f));

  RoomWithCrate() { add_room(scene, kRoom, {wall, wall, wall}); }
  void add_crate(const Bounds3f& box) {
    MeshParts parts;
    append_box(parts[crate], box);
    add_node(scene, "crate", add_mesh(scene, "crate", std::move(parts)));
  }

  // Live sides that see the crate's inside (of surfaces within `box`), and all in total.
  struct Live {
    int inside = 0, outside = 0;  // of the box's surfaces: backs, fronts
    int room_fronts = 0, room_backs = 0;
  };
  Live live_sides(const Bounds3f& box) const {
    const World world(scene);
    const Surfaces surfaces = build_surfaces(world.geometry);
    const auto live = find_live_sides(world.scene, world.geometry, surfaces, world.rays);
    Live count;
    for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
      const SurfaceId s(i);
      const Bounds3f& own = surfaces[s].box;
      const bool front = live[side_of(s, false)] != 0, back = live[side_of(s, true)] != 0;
      if (own.longest_side() > 2.5f) {
        count.room_fronts += front;
        count.room_backs += back;
      } else if (box.contains(own.lower) && box.contains(own.upper)) {
        count.outside += front;
        count.inside += back;
      }
    }
    return count;
  }
};

TEST(LiveSides, InsideOfARoomLivesAndInsideOfACrateDoesNot) {
  RoomWithCrate room;
  room.add_crate(kCrate);
  const auto live = room.live_sides(kCrate);
  EXPECT_EQ(live.room_fronts, 6);
  EXPECT_EQ(live.room_backs, 0);
  EXPECT_EQ(live.outside, 6);
  EXPECT_EQ(live.inside, 0);
}

TEST(LiveSides, SkyWakesTheOutsideOfTheRoom) {
  RoomWithCrate room;
  room.scene.sky = Rgb(1.f);
  EXPECT_EQ(room.live_sides(kCrate).room_backs, 6);
}

TEST(LiveSides, ClearCrateIsLitInside) {
  RoomWithCrate room;
  Material& m = room.scene.materials[room.crate];
  m.alpha_mode = AlphaMode::blend;
  m.alpha = 0.2f;
  room.add_crate(kCrate);
  EXPECT_EQ(room.live_sides(kCrate).inside, 6);
}

TEST(LiveSides, CrateThatGlowsOnBothSidesIsLitInside) {
  RoomWithCrate room;
  room.scene.materials[room.crate].emission = Rgb(1.f);
  room.add_crate(kCrate);
  EXPECT_EQ(room.live_sides(kCrate).inside, 0);
  room.scene.materials[room.crate].double_sided = true;
  EXPECT_EQ(room.live_sides(kCrate).inside, 6);
}

TEST(LiveSides, CrateAroundALampIsLitInside) {
  RoomWithCrate room;
  room.add_crate(kCrate);
  const MaterialId lamp = add_emitter(room.scene, "lamp", Rgb(5.f), Rgb(0.5f));
  MeshParts parts;
  append_box(parts[lamp], {kCrate.center() - 0.1f, kCrate.center() + 0.1f});
  add_node(room.scene, "lamp", add_mesh(room.scene, "lamp", std::move(parts)));
  EXPECT_EQ(room.live_sides(kCrate).inside, 6);
}

// A tiny lamp that rays from the walls rarely meet still lights them.
TEST(LiveSides, CrateAroundAPinpointLampIsLitInside) {
  RoomWithCrate room;
  room.add_crate(kCrate);
  const MaterialId lamp = add_emitter(room.scene, "lamp", Rgb(5000.f), Rgb(0.5f));
  MeshParts parts;
  append_box(parts[lamp], {kCrate.center() - 0.003f, kCrate.center() + 0.003f});
  add_node(room.scene, "lamp", add_mesh(room.scene, "lamp", std::move(parts)));
  EXPECT_EQ(room.live_sides(kCrate).inside, 6);
}

TEST(LiveSides, RoomLitByAPinpointLampLives) {
  RoomWithCrate room;
  const MaterialId lamp = add_emitter(room.scene, "lamp", Rgb(5000.f), Rgb(0.5f));
  MeshParts parts;
  append_box(parts[lamp], {Vec3(2.f), Vec3(2.01f)});
  add_node(room.scene, "lamp", add_mesh(room.scene, "lamp", std::move(parts)));
  EXPECT_EQ(room.live_sides(kCrate).room_fronts, 6);
}

TEST(LiveSides, WideFloorUnderASmallLampLives) {
  testing::QuadScene scene;
  scene.quad({-20, 0, -20}, {0, 0, 40}, {40, 0, 0}, scene.material(0.5f));
  scene.quad({0, 1, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, scene.material(0.5f, 100.f));
  const World world(scene.scene);
  const Surfaces surfaces = build_surfaces(world.geometry);
  const auto live = find_live_sides(world.scene, world.geometry, surfaces, world.rays);
  EXPECT_TRUE(live[side_of(surfaces.of_triangle[TriangleId(0)], false)]);
}

TEST(LiveSides, CrateWithoutALidIsLitInside) {
  RoomWithCrate room;
  MeshParts parts;
  for (const Side side : kAllSides)
    if (side != Side::y_high) append_quad(parts[room.crate], side_of(kCrate, side));
  add_node(room.scene, "open crate", add_mesh(room.scene, "open crate", std::move(parts)));
  EXPECT_EQ(room.live_sides(kCrate).inside, 5);
}

// Five walls of a crate, 0.5 m wide, that stand `gap` above the floor of a room.
int live_insides_of_a_lid(float gap, float height = 0.5f) {
  testing::QuadScene quads;
  const MaterialId grey = quads.material(0.5f), lamp = quads.material(0.f, 10.f);
  quads.box({0, 0, 0}, {4, 3, 4}, grey, true);
  quads.quad({1.5f, 2.9f, 1.5f}, {1, 0, 0}, {0, 0, 1}, lamp);
  MeshParts lid;
  append_box(lid[grey], {{1, gap, 1}, {1.5f, gap + height, 1.5f}});
  Primitive& p = lid[grey];
  // Without the bottom: its triangles are those whose corners all lie at the gap's height.
  std::erase_if(p.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](auto v) { return p.positions[v].y == gap; });
  });
  add_node(quads.scene, "lid", add_mesh(quads.scene, "lid", std::move(lid)));
  const World world(quads.scene);
  const Surfaces surfaces = build_surfaces(world.geometry);
  const auto live = find_live_sides(world.scene, world.geometry, surfaces, world.rays);
  int insides = 0;
  for (std::size_t i = 0; i < surfaces.surfaces.size(); ++i) {
    const SurfaceId s(i);
    const Vec3 size = surfaces[s].box.upper - surfaces[s].box.lower;
    if (std::max(size.x, size.z) < 0.9f && surfaces[s].box.upper.y < 2.8f)
      insides += live[side_of(s, true)] != 0;
  }
  return insides;
}

TEST(LiveSides, InsideOfACrateWithoutABottomIsSealedByTheFloor) {
  EXPECT_EQ(live_insides_of_a_lid(0.f), 0);
}

TEST(LiveSides, InsideOfACrateThatHangsOpenAboveTheFloorLives) {
  EXPECT_EQ(live_insides_of_a_lid(0.1f), 5);
}

// Larger than a quarter of the scene, like the blocks of the Cornell box.
TEST(LiveSides, InsideOfATallBlockIsSealedByTheFloorButNotWhereLightCreepsUnderIt) {
  EXPECT_EQ(live_insides_of_a_lid(0.f, 2.5f), 0);
  EXPECT_EQ(live_insides_of_a_lid(0.01f, 2.5f), 5);
}

}  // namespace
}  // namespace halflight
