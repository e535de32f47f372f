#include "halflight/scene/procedural/office_clutter.h"

#include <string>

#include <glm/ext/matrix_transform.hpp>

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/office_equipment.h"
#include "halflight/scene/procedural/office_furniture.h"

namespace halflight {
namespace {

constexpr float kOnDesk = kDeskTop + kContactGap;
constexpr Vec3 kPenCup{0.66f, kOnDesk, -0.2f};  // on the desk, see office.cpp
constexpr float kPenRadius = 0.004f;

void add_thing(Clutter& clutter, MeshId mesh, const Mat4& local, NodeId parent) {
  ++clutter.placed;
  const std::string name = clutter.scene.meshes[mesh].name + " " + std::to_string(clutter.placed);
  add_node(clutter.scene, name, mesh, local, parent);
}

MeshId any_of(const std::vector<MeshId>& meshes, Random& random) {
  return meshes[static_cast<std::size_t>(random.below(static_cast<int>(meshes.size())))];
}

Mat4 pen_in_cup(int i, Random& random) {
  const Vec3 foot = kPenCup + Vec3(0.f, kPenCupFloor + kContactGap + 0.001f, 0.f);
  const Mat4 round =
      placed_at(foot, 0.5f * kPi * (static_cast<float>(i) + random.uniform(0, 0.6f)));
  const Mat4 out = glm::translate(round, glm::dvec3(0.008, 0.0, 0.0));
  return glm::rotate(out, -static_cast<double>(random.uniform(0.05f, 0.15f)),
                     glm::dvec3(0.0, 0.0, 1.0));
}

Mat4 lying_pen(const Vec3& position, float turn) {
  return glm::rotate(placed_at(position + Vec3(0.f, kPenRadius, 0.f), turn),
                     0.5 * static_cast<double>(kPi), glm::dvec3(1.0, 0.0, 0.0));
}

struct Standing {
  MeshId mesh;
  Vec3 size{0.f};  // thickness, height, depth
};

// Runs of books with a few binders between; `cell` is the room there is along the shelf.
Standing choose_standing(Clutter& clutter, float cell, bool binders, Random& random) {
  if (binders) {
    const float thickness = std::min(cell - 0.001f, 0.075f);
    return {any_of(clutter.objects.binders, random), {thickness, 0.3f, 0.27f}};
  }
  Vec3 size = random_book_size(random);
  size.x = std::min(cell - 0.0005f, 0.055f);
  return {any_of(clutter.objects.books, random), size};
}

}  // namespace

void clutter_desk(Clutter& clutter, NodeId desk, int count, Random& random) {
  int left = std::min(count, kDeskObjects);
  const auto put = [&](MeshId mesh, const Mat4& local) {
    if (left == 0) return;
    --left;
    add_thing(clutter, mesh, local, desk);
  };
  const SmallObjects& objects = clutter.objects;
  put(objects.paper_stack, placed_at({-0.62f, kOnDesk, 0.14f}, random.uniform(-0.2f, 0.2f)));
  for (int i = 0; i < 4; ++i) put(objects.pens[static_cast<std::size_t>(i)], pen_in_cup(i, random));
  Vec3 pile(0.6f, kDeskTop, 0.14f);
  for (int i = 0; i < 5; ++i) {
    const Vec3 size = random_book_size(random);
    pile.y += kContactGap;
    put(any_of(objects.books, random), lying_book(pile, size, random.uniform(-0.25f, 0.25f)));
    pile.y += size.x;
  }
  for (int i = 0; i < 3; ++i) {
    const float height = kOnDesk + kContactGap * static_cast<float>(i);
    const Vec3 at(-0.37f + random.uniform(-0.02f, 0.02f), height, random.uniform(0.f, 0.06f));
    put(objects.sheet, placed_at(at, random.uniform(-0.3f, 0.3f)));
  }
  const float on_sheets = kOnDesk + 3.f * kContactGap;
  put(any_of(objects.pens, random),
      lying_pen({-0.37f, on_sheets, -0.04f}, random.uniform(0.f, 1.2f)));
  put(any_of(objects.pens, random), lying_pen({0.12f, kOnDesk, 0.31f}, random.uniform(1.3f, 1.8f)));
  for (int i = 0; i < 2; ++i) {
    const float height = kOnDesk + kContactGap * static_cast<float>(i);
    put(any_of(objects.notes, random),
        placed_at({0.33f + random.uniform(-0.02f, 0.02f), height, 0.02f}, random.angle()));
  }
}

void fill_board(Clutter& clutter, NodeId shelf, int board, int count, Random& random) {
  if (count == 0) return;
  std::vector<float> weights;
  float total = 0.f;
  for (int i = 0; i < count; ++i) {
    weights.push_back(random.uniform(0.5f, 1.5f));
    total += weights.back();
  }
  const bool binders = count <= 24 && random.uniform() < 0.25f;
  // Few things leave the right end of the board empty rather than grow thick.
  const float most = (binders ? 0.08f : 0.05f) * static_cast<float>(count);
  const float width = std::min(kShelfInnerWidth - 0.01f, most);
  const float lower = shelf_board_top(board) + kContactGap;
  float x = -0.5f * kShelfInnerWidth + 0.005f;
  for (const float weight : weights) {
    const float cell = width * weight / total;
    const Standing thing = choose_standing(clutter, cell, binders, random);
    // Spines line up near the front edge, not exactly.
    const float z = 0.5f * kShelfDepth - 0.01f - thing.size.z - random.uniform(0.f, 0.015f);
    add_thing(clutter, thing.mesh, placed_at({x, lower, z}, 0.f, thing.size), shelf);
    x += cell;
  }
}

}  // namespace halflight
