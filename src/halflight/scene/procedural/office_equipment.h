// What stands on a desk whatever the clutter. Each stands on the origin with its user towards +z.
#pragma once

#include "halflight/scene/procedural/office_palette.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct Equipment {
  MeshId monitor, keyboard, mouse, lamp, mug, pen_cup, phone;
};
Equipment add_equipment(Scene& scene, const OfficePalette& palette);

inline constexpr float kPenCupFloor = 0.003f;  // height of its inside, metres

}  // namespace halflight
