#include "halflight/scene/procedural/doorway.h"

#include "halflight/scene/procedural/assembly.h"

namespace halflight {
namespace {

constexpr float kLength = 4.f;  // of each room along x
constexpr float kWidth = 3.f;   // along z
constexpr float kHeight = 2.6f;

// Seen from the doorway's middle: the room that begins at |x| = wall / 2 on the side `sign` of x.
// Corners of the doorway are corners of the wall and floor as well, so that the shell has no gaps.
struct Shell {
  Primitive floor, walls, ceiling;
};

void append_facing(Primitive& to, Vec3 a, Vec3 b, Vec3 c, bool mirrored) {
  if (mirrored) std::swap(b, c);
  append_triangle(to, a, b, c);
}

// One room with its wall around the door. Written for the side +x; mirrored turns it to -x.
void append_half(Shell& shell, const DoorwayParameters& p, bool mirrored) {
  const float near = 0.5f * p.wall_thickness, far = near + kLength, w = 0.5f * kWidth;
  const float d = 0.5f * p.door_width, h = p.door_height;
  const auto at = [&](float x, float y, float z) { return Vec3(mirrored ? -x : x, y, z); };
  const auto triangle = [&](Primitive& to, Vec3 a, Vec3 b, Vec3 c) {
    append_facing(to, a, b, c, mirrored);
  };
  const auto quad = [&](Primitive& to, Vec3 a, Vec3 b, Vec3 c, Vec3 e) {
    triangle(to, a, b, c);
    triangle(to, a, c, e);
  };
  const Vec3 low_left = at(near, 0, -w), low_right = at(near, 0, w);
  const Vec3 high_left = at(near, kHeight, -w), high_right = at(near, kHeight, w);
  const Vec3 foot_left = at(near, 0, -d), foot_right = at(near, 0, d);
  const Vec3 head_left = at(near, h, -d), head_right = at(near, h, d);
  const Vec3 far_low_left = at(far, 0, -w), far_low_right = at(far, 0, w);
  const Vec3 far_high_left = at(far, kHeight, -w), far_high_right = at(far, kHeight, w);

  // The wall around the door, seen from +x.
  triangle(shell.walls, low_left, high_left, foot_left);
  triangle(shell.walls, foot_left, high_left, head_left);
  quad(shell.walls, head_left, high_left, high_right, head_right);
  triangle(shell.walls, foot_right, head_right, high_right);
  triangle(shell.walls, foot_right, high_right, low_right);
  // The other three.
  quad(shell.walls, far_low_left, far_low_right, far_high_right, far_high_left);
  quad(shell.walls, low_left, far_low_left, far_high_left, high_left);
  quad(shell.walls, low_right, high_right, far_high_right, far_low_right);
  quad(shell.ceiling, high_left, far_high_left, far_high_right, high_right);
  triangle(shell.floor, low_left, foot_left, far_low_left);
  triangle(shell.floor, foot_left, foot_right, far_low_left);
  triangle(shell.floor, foot_right, far_low_right, far_low_left);
  triangle(shell.floor, foot_right, low_right, far_low_right);
  // Half of the threshold, lintel and jambs would meet in the middle of the wall: whole ones are
  // added once, by append_reveal.
}

void append_reveal(Shell& shell, const DoorwayParameters& p) {
  const Bounds3f opening{{-0.5f * p.wall_thickness, 0.f, -0.5f * p.door_width},
                         {0.5f * p.wall_thickness, p.door_height, 0.5f * p.door_width}};
  append_quad(shell.floor, side_of(opening, Side::y_low, Facing::inwards));
  for (const Side side : {Side::y_high, Side::z_low, Side::z_high})
    append_quad(shell.walls, side_of(opening, side, Facing::inwards));
}

}  // namespace

Knobs knobs(DoorwayParameters& p) {
  return {{"door-width", "width of the doorway, metres", &p.door_width, 0.01, 2.9},
          {"door-height", "height of the doorway, metres", &p.door_height, 0.01, 2.5},
          {"wall-thickness", "thickness of the wall between, metres", &p.wall_thickness, 0.01, 1}};
}

Scene doorway_scene(const DoorwayParameters& p) {
  Scene scene;
  const RoomMaterials materials =
      add_room_materials(scene, {0.35f, 0.25f, 0.18f}, {0.72f, 0.70f, 0.66f}, Rgb(0.8f));
  Shell shell;
  append_half(shell, p, true);
  append_half(shell, p, false);
  append_reveal(shell, p);
  MeshParts parts;
  parts[materials.floor] = std::move(shell.floor);
  parts[materials.walls] = std::move(shell.walls);
  parts[materials.ceiling] = std::move(shell.ceiling);
  add_node(scene, "rooms", add_mesh(scene, "rooms", std::move(parts)));

  const MaterialId light = add_emitter(scene, "light", {20.f, 18.f, 15.f}, Rgb(0.5f));
  const LightPanel panel{1.2f, 0.6f, 0.05f};
  const MeshId mesh = add_light_panel(scene, panel, light, materials.ceiling);
  const float bright_room = -0.5f * (p.wall_thickness + kLength);
  add_node(scene, "ceiling light", mesh, placed_at({bright_room, kHeight - 0.1f, 0.f}));
  add_camera(scene, "dark room", {kLength - 0.3f, 1.6f, 1.2f}, {0.f, 1.1f, 0.f}, 1.f);
  add_camera(scene, "bright room", {0.3f - kLength, 1.6f, 1.2f}, {0.f, 1.1f, 0.f}, 1.f);
  return scene;
}

}  // namespace halflight
