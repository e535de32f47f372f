#include "halflight/scene/procedural/office_equipment.h"

#include <glm/ext/matrix_transform.hpp>

#include "halflight/scene/procedural/assembly.h"

namespace halflight {
namespace {

MeshId add_monitor(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_cushion(parts[p.black_plastic], {{-0.13f, 0.f, -0.09f}, {0.13f, 0.012f, 0.09f}}, 0.04f,
                 0.003f);
  append_box(parts[p.black_plastic], {{-0.03f, 0.012f, -0.05f}, {0.03f, 0.3f, -0.035f}});
  append_box(parts[p.black_plastic], {{-0.31f, 0.13f, -0.034f}, {0.31f, 0.5f, -0.01f}});
  const Bounds3f picture{{-0.3f, 0.145f, -0.0095f}, {0.3f, 0.49f, -0.0095f}};
  append_quad(parts[p.screen], side_of(picture, Side::z_high));
  return add_mesh(scene, "monitor", std::move(parts));
}

MeshId add_keyboard(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_cushion(parts[p.black_plastic], {{-0.22f, 0.f, -0.075f}, {0.22f, 0.015f, 0.075f}}, 0.01f,
                 0.002f);
  constexpr float kPitch = 0.0275f, kKey = 0.023f;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 15; ++column) {
      const float x = -0.205f + kPitch * static_cast<float>(column);
      const float z = -0.066f + kPitch * static_cast<float>(row);
      append_box(parts[p.white_plastic], {{x, 0.0155f, z}, {x + kKey, 0.021f, z + kKey}});
    }
  }
  return add_mesh(scene, "keyboard", std::move(parts));
}

MeshId add_mouse(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_cushion(parts[p.white_plastic], {{-0.03f, 0.f, -0.05f}, {0.03f, 0.032f, 0.05f}}, 0.028f,
                 0.012f);
  return add_mesh(scene, "mouse", std::move(parts));
}

// An arm in two pieces and a conical shade, open downwards; the bulb is the disc inside it.
MeshId add_lamp(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  const Vec3 foot(0.f, 0.02f, 0.f), elbow(-0.08f, 0.34f, 0.f), wrist(0.16f, 0.46f, 0.12f);
  append_rod(parts[p.steel], {0.f, 0.f, 0.f}, {0.f, 0.022f, 0.f}, 0.085f, 24);
  append_rod(parts[p.steel], foot, elbow, 0.007f, 8);
  append_rod(parts[p.steel], elbow, wrist, 0.006f, 8);
  const Vec3 up = glm::normalize(Vec3(-0.2f, 1.f, -0.15f));
  constexpr float kOpening = 0.075f, kApex = 0.03f, kHeight = 0.11f, kSheet = 0.002f;
  constexpr std::array<Vec2, 5> kShade{Vec2(0.038f, 0.08f),
                                       {kOpening - kSheet, 0.f},
                                       {kOpening, 0.f},
                                       {kApex, kHeight},
                                       {0.f, kHeight}};
  constexpr std::array<Vec2, 2> kBulb{Vec2(0.f, 0.08f), {0.038f, 0.08f}};
  const Vec3 base = wrist - kHeight * up;
  append_revolution(parts[p.lamp_shade], base, up, kShade, 24);
  append_revolution(parts[p.lamp], base, up, kBulb, 24);
  return add_mesh(scene, "desk lamp", std::move(parts));
}

MeshId add_mug(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_vessel(parts[p.ceramic], Vec3(0.f), {0.038f, 0.04f, 0.095f, 0.004f}, 24);
  const std::array handle{Vec3(0.036f, 0.078f, 0.f), Vec3(0.066f, 0.07f, 0.f),
                          Vec3(0.066f, 0.032f, 0.f), Vec3(0.036f, 0.022f, 0.f)};
  for (std::size_t i = 0; i + 1 < handle.size(); ++i)
    append_rod(parts[p.ceramic], handle[i], handle[i + 1], 0.005f, 8);
  return add_mesh(scene, "mug", std::move(parts));
}

MeshId add_pen_cup(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_vessel(parts[p.steel], Vec3(0.f), {0.036f, 0.036f, 0.1f, kPenCupFloor}, 20);
  return add_mesh(scene, "pen cup", std::move(parts));
}

MeshId add_phone(Scene& scene, const OfficePalette& p) {
  MeshParts parts;
  append_cushion(parts[p.black_plastic], {{-0.09f, 0.f, -0.1f}, {0.09f, 0.03f, 0.1f}}, 0.02f,
                 0.006f);
  append_cushion(parts[p.black_plastic], {{-0.085f, 0.0305f, -0.09f}, {-0.035f, 0.06f, 0.09f}},
                 0.02f, 0.01f);
  for (int i = 0; i < 12; ++i) {
    const int column = i % 3, row = i / 3;
    const float x = -0.01f + 0.026f * static_cast<float>(column);
    const float z = -0.03f + 0.026f * static_cast<float>(row);
    append_box(parts[p.white_plastic], {{x, 0.0305f, z}, {x + 0.018f, 0.035f, z + 0.018f}});
  }
  return add_mesh(scene, "phone", std::move(parts));
}

}  // namespace

Equipment add_equipment(Scene& scene, const OfficePalette& p) {
  Equipment e;
  e.monitor = add_monitor(scene, p);
  e.keyboard = add_keyboard(scene, p);
  e.mouse = add_mouse(scene, p);
  e.lamp = add_lamp(scene, p);
  e.mug = add_mug(scene, p);
  e.pen_cup = add_pen_cup(scene, p);
  e.phone = add_phone(scene, p);
  return e;
}

}  // namespace halflight
