// Spreads a number of small things over the desk and the shelves of one workplace.
#pragma once

#include <array>
#include <cstdint>

#include "halflight/scene/procedural/small_objects.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Every small thing is a node of its own; they are numbered through the office.
struct Clutter {
  Scene& scene;
  const SmallObjects& objects;
  int placed = 0;
};

// At most this many go on a desk; the order is fixed, so that fewer still look like a desk.
inline constexpr int kDeskObjects = 17;
void clutter_desk(Clutter& clutter, NodeId desk, int count, Random& random);

// Exactly `count` books and binders side by side on one shelf board.
void fill_board(Clutter& clutter, NodeId shelf, int board, int count, Random& random);

}  // namespace halflight
