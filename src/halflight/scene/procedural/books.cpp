#include "halflight/scene/procedural/books.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/small_objects.h"

namespace halflight {
namespace {

constexpr float kDepth = 0.28f;      // of the boards
constexpr float kPitch = 0.34f;      // from board to board
constexpr float kThickness = 0.02f;  // of boards and sides
constexpr float kLowest = 0.1f;      // top of the first board
constexpr float kStanding = 0.7f;    // share of the width; a pile lies on the rest
constexpr int kPile = 4;
constexpr float kHeight = 2.6f, kHalfRoom = 1.6f;

float board_top(int board) { return kLowest + kPitch * static_cast<float>(board); }

void add_shelf(Scene& scene, const BooksParameters& p) {
  const MaterialId wood = add_material(scene, "wood", {0.55f, 0.42f, 0.28f});
  const float x = 0.5f * p.width, top = board_top(p.boards);
  MeshParts parts;
  Primitive& part = parts[wood];
  append_box(part, {{-x - kThickness, 0.f, 0.f}, {-x, top, kDepth}});
  append_box(part, {{x, 0.f, 0.f}, {x + kThickness, top, kDepth}});
  append_box(part, {{-x, 0.f, 0.f}, {x, top, 0.01f}});
  for (int board = 0; board <= p.boards; ++board)
    append_box(part, {{-x, board_top(board) - kThickness, 0.01f}, {x, board_top(board), kDepth}});
  add_node(scene, "shelf", add_mesh(scene, "shelf", std::move(parts)),
           placed_at({0.f, 0.f, -kHalfRoom + kContactGap}));
}

void fill_board(Scene& scene, const BooksParameters& p, int board,
                const std::vector<MeshId>& books) {
  Random random(hash(static_cast<std::uint64_t>(p.seed), board));
  const NodeId parent = add_group(scene, "board " + std::to_string(board + 1));
  int count = 0;
  const auto add = [&](const Mat4& local) {
    const MeshId book =
        books[static_cast<std::size_t>(random.below(static_cast<int>(books.size())))];
    add_node(scene, "book " + std::to_string(++count), book, local, parent);
  };
  const float floor = board_top(board) + kContactGap;
  const float front = -kHalfRoom + kDepth - 0.01f, left = -0.5f * p.width + kContactGap;
  float x = left;
  for (Vec3 size = random_book_size(random); x + size.x < left + kStanding * p.width;
       size = random_book_size(random)) {
    const float z = front - size.z - random.uniform(0.f, 0.015f);
    add(placed_at({x, floor, z}, 0.f, size));
    x += size.x + kContactGap;
  }
  // The longest book that fits lies across what is left of the board.
  const float room = 0.5f * p.width - x - 2.f * kContactGap;
  float y = floor;
  for (int i = 0; i < kPile; ++i) {
    Vec3 size = random_book_size(random);
    size *= std::min(1.f, 0.95f * std::min(room / size.y, 0.2f / size.z));
    add(lying_book({x + 0.5f * room, y, front - 0.5f * size.z - 0.01f}, size, 0.f));
    y += size.x + kContactGap;
  }
}

}  // namespace

Knobs knobs(BooksParameters& p) {
  return {{"boards", "rows of books", &p.boards, 1, 6},
          {"width", "inner width of the shelf, metres", &p.width, 0.6, 2.8},
          {"seed", "sizes and colours of the books", &p.seed, 0, 1e9}};
}

Scene books_scene(const BooksParameters& p) {
  Scene scene;
  const RoomMaterials room = add_room_materials(scene, {0.4f, 0.34f, 0.28f}, Rgb(0.7f), Rgb(0.8f));
  add_room(scene, {{-kHalfRoom, 0.f, -kHalfRoom}, {kHalfRoom, kHeight, kHalfRoom}}, room);
  add_shelf(scene, p);
  const std::vector<MeshId> books = add_books(scene);
  for (int board = 0; board < p.boards; ++board) fill_board(scene, p, board, books);
  const MaterialId light = add_emitter(scene, "light", Rgb(30.f), Rgb(0.f));
  add_node(scene, "light", add_light_panel(scene, {0.5f, 0.5f, 0.05f}, light, room.ceiling),
           placed_at({0.7f, kHeight - 0.15f, 0.3f}));
  const float middle = 0.5f * board_top(p.boards);
  add_camera(scene, "shelf", {-0.5f, middle + 0.35f, 0.4f}, {0.f, middle, -kHalfRoom + 0.2f}, 0.6f);
  return scene;
}

}  // namespace halflight
