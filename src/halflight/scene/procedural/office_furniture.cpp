#include "halflight/scene/procedural/office_furniture.h"

#include <glm/ext/matrix_transform.hpp>

#include "halflight/scene/procedural/assembly.h"

namespace halflight {
namespace {

MeshId add_desk(Scene& scene, const OfficePalette& p) {
  const float x = 0.5f * kDeskWidth, z = 0.5f * kDeskDepth;
  MeshParts parts;
  append_cushion(parts[p.wood], {{-x, kDeskTop - 0.03f, -z}, {x, kDeskTop, z}}, 0.03f, 0.004f);
  const float under = kDeskTop - 0.031f;
  for (const float side : {-1.f, 1.f}) {
    const float at = side * (x - 0.06f);
    append_box(parts[p.steel], {{at - 0.03f, 0.f, -z + 0.06f}, {at + 0.03f, 0.03f, z - 0.06f}});
    append_box(parts[p.steel], {{at - 0.025f, 0.031f, -0.04f}, {at + 0.025f, under, 0.04f}});
  }
  append_box(parts[p.steel], {{-x + 0.12f, 0.35f, -z + 0.04f}, {x - 0.12f, under, -z + 0.055f}});
  // Drawers under the user's right hand.
  append_box(parts[p.wood], {{0.26f, 0.06f, -0.28f}, {0.66f, 0.62f, 0.3f}});
  for (int drawer = 0; drawer < 3; ++drawer) {
    const float low = 0.07f + 0.185f * static_cast<float>(drawer);
    append_box(parts[p.dark_wood], {{0.27f, low, 0.301f}, {0.65f, low + 0.175f, 0.319f}});
    append_rod(parts[p.steel], {0.4f, low + 0.13f, 0.33f}, {0.52f, low + 0.13f, 0.33f}, 0.006f, 8);
  }
  return add_mesh(scene, "desk", std::move(parts));
}

MeshId add_chair(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  for (int i = 0; i < 5; ++i) {
    const float phi = 2.f * kPi * (static_cast<float>(i) + 0.25f) / 5.f;
    const Vec3 out(std::cos(phi), 0.f, std::sin(phi));
    append_rod(parts[p.black_plastic], Vec3(0.f, 0.1f, 0.f), 0.29f * out + Vec3(0, 0.07f, 0),
               0.018f, 8);
    const Vec3 axle = 0.012f * glm::cross(out, Vec3(0.f, 1.f, 0.f));
    const Vec3 hub = 0.29f * out + Vec3(0.f, 0.03f, 0.f);
    append_rod(parts[p.black_plastic], hub - axle, hub + axle, 0.03f, 12);
  }
  append_rod(parts[p.steel], {0.f, 0.08f, 0.f}, {0.f, 0.43f, 0.f}, 0.025f, 12);
  append_cushion(parts[p.fabric], {{-0.24f, 0.42f, -0.24f}, {0.24f, 0.49f, 0.24f}}, 0.08f, 0.02f);
  append_rod(parts[p.steel], {0.f, 0.44f, 0.18f}, {0.f, 0.66f, 0.31f}, 0.018f, 8);
  // The back: a cushion stood up, leaning away from the user's desk at -z.
  Primitive back;
  append_cushion(back, {{-0.22f, -0.03f, -0.28f}, {0.22f, 0.03f, 0.28f}}, 0.09f, 0.018f);
  const Mat4 raised = glm::translate(Mat4(1.0), glm::dvec3(0.0, 0.82, 0.3));
  append_moved(parts[p.fabric], back, glm::rotate(raised, -1.42, glm::dvec3(1.0, 0.0, 0.0)));
  for (const float side : {-1.f, 1.f}) {
    const float x = 0.265f * side;
    append_rod(parts[p.black_plastic], {0.2f * side, 0.44f, 0.f}, {x, 0.44f, 0.f}, 0.012f, 8);
    append_rod(parts[p.black_plastic], {x, 0.44f, 0.f}, {x, 0.64f, 0.03f}, 0.012f, 8);
    append_cushion(parts[p.black_plastic], {{x - 0.03f, 0.63f, -0.12f}, {x + 0.03f, 0.655f, 0.14f}},
                   0.025f, 0.006f);
  }
  return add_mesh(scene, "chair", std::move(parts));
}

MeshId add_shelf(Scene& scene, const OfficePalette& p) {
  const float x = 0.5f * kShelfInnerWidth, z = 0.5f * kShelfDepth;
  const float top = shelf_board_top(kShelfBoards);
  MeshParts parts;
  for (const float side : {-1.f, 1.f}) {
    const float inner = side * x, outer = side * (x + 0.02f);
    append_box(parts[p.wood],
               {{std::min(inner, outer), 0.f, -z}, {std::max(inner, outer), top, z}});
  }
  append_box(parts[p.wood], {{-x, 0.f, -z}, {x, top, -z + 0.01f}});
  for (int board = 0; board <= kShelfBoards; ++board) {
    const float height = shelf_board_top(board);
    append_box(parts[p.wood], {{-x, height - 0.02f, -z + 0.01f}, {x, height, z}});
  }
  return add_mesh(scene, "shelf", std::move(parts));
}

MeshId add_divider(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_box(parts[p.divider], {{-0.8f, 0.6f, -0.015f}, {0.8f, 1.12f, 0.015f}});
  return add_mesh(scene, "divider", std::move(parts));
}

MeshId add_bin(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_vessel(parts[p.black_plastic], Vec3(0.f), {0.12f, 0.15f, 0.32f, 0.004f}, 24);
  return add_mesh(scene, "bin", std::move(parts));
}

// Bars around an opening of width x height whose lower edge is at `sill`.
void append_frame(Primitive& to, float width, float height, float sill, float bar, float depth) {
  const float x = 0.5f * width, top = sill + height;
  append_box(to, {{-x - bar, sill - bar, 0.f}, {-x, top + bar, depth}});
  append_box(to, {{x, sill - bar, 0.f}, {x + bar, top + bar, depth}});
  append_box(to, {{-x, sill - bar, 0.f}, {x, sill, depth}});
  append_box(to, {{-x, top, 0.f}, {x, top + bar, depth}});
}

MeshId add_door(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_box(parts[p.dark_wood], {{-0.45f, 0.f, 0.f}, {0.45f, 2.05f, 0.03f}});
  Primitive& frame = parts[p.white_plastic];
  append_box(frame, {{-0.52f, 0.f, 0.f}, {-0.45f, 2.12f, 0.05f}});
  append_box(frame, {{0.45f, 0.f, 0.f}, {0.52f, 2.12f, 0.05f}});
  append_box(frame, {{-0.45f, 2.05f, 0.f}, {0.45f, 2.12f, 0.05f}});
  append_rod(parts[p.steel], {0.38f, 1.02f, 0.03f}, {0.38f, 1.02f, 0.08f}, 0.01f, 10);
  append_rod(parts[p.steel], {0.39f, 1.02f, 0.085f}, {0.26f, 1.02f, 0.085f}, 0.009f, 10);
  return add_mesh(scene, "door", std::move(parts));
}

// Daylight as an emitting pane behind a frame with a cross of bars.
MeshId add_window(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  Primitive& frame = parts[p.white_plastic];
  append_frame(frame, 1.8f, 1.4f, 0.95f, 0.06f, 0.08f);
  append_box(frame, {{-0.02f, 0.95f, 0.02f}, {0.02f, 2.35f, 0.06f}});
  append_box(frame, {{-0.9f, 1.88f, 0.02f}, {-0.02f, 1.92f, 0.06f}});
  append_box(frame, {{0.02f, 1.88f, 0.02f}, {0.9f, 1.92f, 0.06f}});
  append_box(frame, {{-1.f, 0.86f, 0.f}, {1.f, 0.889f, 0.18f}});
  const Bounds3f pane{{-0.9f, 0.95f, 0.01f}, {0.9f, 2.35f, 0.01f}};
  append_quad(parts[p.daylight], side_of(pane, Side::z_high));
  return add_mesh(scene, "window", std::move(parts));
}

MeshId add_whiteboard(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_box(parts[p.whiteboard], {{-0.9f, 0.95f, 0.f}, {0.9f, 2.05f, 0.015f}});
  append_frame(parts[p.steel], 1.8f, 1.1f, 0.95f, 0.02f, 0.025f);
  append_box(parts[p.steel], {{-0.5f, 0.9f, 0.f}, {0.5f, 0.925f, 0.07f}});
  const std::array inks{p.fabric, p.lamp_shade, p.divider};
  for (int line = 0; line < 9; ++line) {
    const float y = 1.9f - 0.09f * static_cast<float>(line), indent = line % 3 == 0 ? 0.f : 0.1f;
    const float length = 0.5f + 0.13f * static_cast<float>(line * 5 % 7);
    const Bounds3f stroke{{-0.75f + indent, y, 0.0155f}, {-0.75f + length, y + 0.02f, 0.0155f}};
    append_quad(parts[inks[line / 3]], side_of(stroke, Side::z_high));
  }
  return add_mesh(scene, "whiteboard", std::move(parts));
}

MeshId add_clock(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  const Vec3 center(0.f, 2.3f, 0.f);
  append_rod(parts[p.black_plastic], center, center + Vec3(0.f, 0.f, 0.03f), 0.16f, 32);
  append_rod(parts[p.whiteboard], center + Vec3(0.f, 0.f, 0.0305f),
             center + Vec3(0.f, 0.f, 0.0315f), 0.145f, 32);
  const Vec3 hands = center + Vec3(0.f, 0.f, 0.036f);
  append_rod(parts[p.black_plastic], hands, hands + Vec3(-0.05f, 0.05f, 0.f), 0.004f, 6);
  append_rod(parts[p.black_plastic], hands + Vec3(0.f, 0.f, 0.009f),
             hands + Vec3(0.06f, 0.09f, 0.009f), 0.003f, 6);
  return add_mesh(scene, "clock", std::move(parts));
}

}  // namespace

Furniture add_furniture(Scene& scene, const OfficePalette& p) {
  Furniture f;
  f.desk = add_desk(scene, p);
  f.chair = add_chair(scene, p);
  f.shelf = add_shelf(scene, p);
  f.divider = add_divider(scene, p);
  f.bin = add_bin(scene, p);
  f.door = add_door(scene, p);
  f.window = add_window(scene, p);
  f.whiteboard = add_whiteboard(scene, p);
  f.clock = add_clock(scene, p);
  return f;
}

}  // namespace halflight
