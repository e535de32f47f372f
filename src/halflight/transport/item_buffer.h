// The item buffer (paper section 6.1): an orthographic picture of a cluster's contents in which
// every pixel holds the item that is seen there. The pixels of an item are its visible projected
// area, for all items in time linear in the contents.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/visibility/orthographic.h"

namespace halflight {

struct ItemPixels {
  std::uint32_t covered = 0;  // by the item's projection
  std::uint32_t seen = 0;     // in which nothing lies before it
};

// Pixels along the longer side, so that the smallest item that is seen face on covers about 4: at
// least 32, at most 256.
int item_resolution(const Bounds3f& box, float smallest_area);

// Projected area of each item that is seen from far away towards d (unit), m2; the picture is as
// fine as the smallest item asks for. Items that face away have none.
std::vector<float> visible_areas(const ElementTree& tree, std::span<const ElementId> items,
                                 const IdVector<ElementId, float>& opacity, const Vec3& d);

// Reused from one direction to the next; each task has its own.
class ItemBuffer {
 public:
  // The items are cells, both sides of a surface where both are live. A side that never sees light
  // hides what lies behind it all the same. Items of which less than half is opaque hide nothing.
  ItemBuffer(const ElementTree& tree, std::span<const ElementId> items,
             const IdVector<ElementId, float>& opacity, int resolution);

  // Items that face d (unit) are seen by a viewer far away towards d, the others by one on the
  // opposite side: one picture of each.
  void look_along(const Vec3& d, std::span<ItemPixels> pixels);

  // What an item looks like along the last direction, in m2.
  float pixel_area() const { return pixel_ * pixel_; }

 private:
  struct Item {
    Vec3 normal{0.f};
    std::uint32_t first_piece = 0, piece_count = 0;
    bool hides = true;       // opaque
    bool back_hides = true;  // the other side is no item, but an obstacle
  };
  struct Piece {
    std::uint32_t first_corner = 0, corner_count = 0;
  };
  // Heights along the direction; what is higher than all else is seen from above, what is lowest
  // from below.
  struct Picture {
    std::vector<float> height;
    std::vector<std::int32_t> item;
  };

  template <class Draw>
  void for_each_pixel(const Easel& easel, const Item& item, const Draw& draw);

  Bounds3f box_;  // about the origin
  int resolution_;
  float pixel_ = 0.f;
  std::vector<Item> items_;
  std::vector<Piece> pieces_;
  std::vector<Vec3> corners_;
  std::vector<PictureEdge> edges_;
  Picture above_, below_;
};

}  // namespace halflight
