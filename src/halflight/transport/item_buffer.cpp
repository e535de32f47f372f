#include "halflight/transport/item_buffer.h"

namespace halflight {
namespace {

constexpr int kLeastResolution = 32, kMostResolution = 256;
constexpr float kTurn = 0.2f;          // of the picture: most things are built square
constexpr float kLeastCosine = 1e-3f;  // an item seen more obliquely covers nothing
constexpr float kLeastOpacity = 0.5f;  // that hides
constexpr std::int32_t kNoItem = -1;
// Items above this many pixels are measured by the share of them that is seen, which edges disturb
// less than the count.
constexpr float kSmallItem = 4.f;

}  // namespace

int item_resolution(const Bounds3f& box, float smallest_area) {
  const float wanted = 2.f * box.longest_side() / std::sqrt(std::max(smallest_area, 1e-30f));
  return static_cast<int>(std::ceil(std::clamp(wanted, static_cast<float>(kLeastResolution),
                                               static_cast<float>(kMostResolution))));
}

ItemBuffer::ItemBuffer(const ElementTree& tree, std::span<const ElementId> items,
                       const IdVector<ElementId, float>& opacity, int resolution)
    : resolution_(resolution) {
  Bounds3f box;
  for (const ElementId cell : items) box.extend(tree[cell].box);
  // Small things far from the origin keep their digits.
  const Vec3 center = box.center();
  box_ = {box.lower - center, box.upper - center};
  for (const ElementId cell : items) {
    const SideId side = tree[cell].side;
    Item item;
    item.normal = tree.normal(cell);
    item.hides = opacity[cell] >= kLeastOpacity;
    item.back_hides = item.hides && !tree.side_root(SideId(side.value ^ 1u)).valid();
    item.first_piece = static_cast<std::uint32_t>(pieces_.size());
    tree.for_each_piece(cell, [&](std::span<const Vec3> piece) {
      pieces_.push_back(
          {static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(piece.size())});
      for (const Vec3& p : piece) corners_.push_back(p - center);
    });
    item.piece_count = static_cast<std::uint32_t>(pieces_.size()) - item.first_piece;
    items_.push_back(item);
  }
}

// Calls draw(pixel, height in pixels).
template <class Draw>
void ItemBuffer::for_each_pixel(const Easel& easel, const Item& item, const Draw& draw) {
  const float facing = glm::dot(item.normal, easel.frame.normal);
  if (std::abs(facing) < kLeastCosine) return;
  const float slope_x = -glm::dot(item.normal, easel.frame.tangent) / facing;
  const float slope_y = -glm::dot(item.normal, easel.frame.bitangent) / facing;
  for (std::uint32_t i = 0; i < item.piece_count; ++i) {
    const Piece& piece = pieces_[item.first_piece + i];
    const std::span<const Vec3> corners(corners_.data() + piece.first_corner, piece.corner_count);
    edges_.clear();
    const Vec2 start = easel.to_pixels(corners[0]);
    Vec2 from = start;
    for (std::size_t k = 1; k <= corners.size(); ++k) {
      const Vec2 to = k < corners.size() ? easel.to_pixels(corners[k]) : start;
      edges_.emplace_back(from, to);
      from = to;
    }
    const float at_start = glm::dot(corners[0], easel.frame.normal) / easel.pixel;
    for_each_row(easel, edges_, [&](int y, int x0, int x1) {
      const float row = at_start + slope_y * (static_cast<float>(y) + 0.5f - start.y) +
                        slope_x * (0.5f - start.x);
      const auto first = static_cast<std::size_t>(y) * static_cast<std::size_t>(easel.width);
      for (int x = x0; x <= x1; ++x)
        draw(first + static_cast<std::size_t>(x), row + slope_x * static_cast<float>(x));
    });
  }
}

void ItemBuffer::look_along(const Vec3& d, std::span<ItemPixels> pixels) {
  const Easel easel(box_, d, resolution_, kTurn);
  pixel_ = easel.pixel;
  const auto n = static_cast<std::size_t>(easel.width) * static_cast<std::size_t>(easel.height);
  above_.height.assign(n, -kInfinity);
  below_.height.assign(n, kInfinity);
  above_.item.assign(n, kNoItem);
  below_.item.assign(n, kNoItem);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    pixels[i] = {};
    if (!item.hides) continue;
    const bool up = glm::dot(item.normal, d) > 0.f;
    const auto id = static_cast<std::int32_t>(i);
    const bool draw_above = up || item.back_hides, draw_below = !up || item.back_hides;
    std::uint32_t covered = 0;
    for_each_pixel(easel, item, [&](std::size_t p, float height) {
      ++covered;
      if (draw_above && height > above_.height[p]) {
        above_.height[p] = height;
        above_.item[p] = up ? id : kNoItem;
      }
      if (draw_below && height < below_.height[p]) {
        below_.height[p] = height;
        below_.item[p] = up ? kNoItem : id;
      }
    });
    pixels[i].covered = covered;
  }
  for (const Picture* picture : {&above_, &below_})
    for (const std::int32_t id : picture->item)
      if (id != kNoItem) ++pixels[static_cast<std::size_t>(id)].seen;
  // What hides nothing is only held against the rest.
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (items_[i].hides) continue;
    const bool up = glm::dot(items_[i].normal, d) > 0.f;
    for_each_pixel(easel, items_[i], [&](std::size_t p, float height) {
      ++pixels[i].covered;
      if (up ? height >= above_.height[p] : height <= below_.height[p]) ++pixels[i].seen;
    });
  }
}

std::vector<float> visible_areas(const ElementTree& tree, std::span<const ElementId> items,
                                 const IdVector<ElementId, float>& opacity, const Vec3& d) {
  Bounds3f box;
  float smallest = kInfinity;
  for (const ElementId item : items) {
    box.extend(tree[item].box);
    smallest = std::min(smallest, tree[item].area);
  }
  ItemBuffer buffer(tree, items, opacity, item_resolution(box, smallest));
  std::vector<ItemPixels> pixels(items.size());
  buffer.look_along(d, pixels);
  std::vector<float> areas(items.size(), 0.f);
  // Of small items the counts are right on the mean alone: what would exceed one is given to the
  // others.
  float counted = 0.f, taken = 0.f;
  const auto projected = [&](std::size_t i) {
    return tree[items[i]].area * std::max(0.f, glm::dot(tree.normal(items[i]), d));
  };
  const auto is_small = [&](std::size_t i) {
    return projected(i) < kSmallItem * buffer.pixel_area();
  };
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!(projected(i) > 0.f)) continue;
    const auto [covered, seen] = pixels[i];
    if (is_small(i)) {
      const float count = static_cast<float>(seen) * buffer.pixel_area();
      areas[i] = std::min(projected(i), count);
      counted += count;
      taken += areas[i];
    } else {
      areas[i] =
          projected(i) * static_cast<float>(seen) / static_cast<float>(std::max(covered, 1u));
    }
  }
  for (std::size_t i = 0; i < items.size(); ++i)
    if (is_small(i) && taken > 0.f) areas[i] *= counted / taken;
  return areas;
}

}  // namespace halflight
