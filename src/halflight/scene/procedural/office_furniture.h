// Furniture of the office, at real size. Each stands on the origin; its user, or the middle of the
// room, is towards +z.
#pragma once

#include "halflight/scene/procedural/office_palette.h"
#include "halflight/scene/scene.h"

namespace halflight {

inline constexpr float kDeskTop = 0.74f;  // height, metres
inline constexpr float kDeskWidth = 1.6f;
inline constexpr float kDeskDepth = 0.78f;

inline constexpr int kShelfBoards = 6;
inline constexpr float kShelfInnerWidth = 0.96f;
inline constexpr float kShelfDepth = 0.3f;
inline constexpr float kShelfPitch = 0.34f;
// Height of the upper face of a board, counted from the bottom.
constexpr float shelf_board_top(int board) {
  return 0.08f + kShelfPitch * static_cast<float>(board);
}

struct Furniture {
  MeshId desk, chair, shelf, divider, bin, door, window, whiteboard, clock;
};
Furniture add_furniture(Scene& scene, const OfficePalette& palette);

}  // namespace halflight
