#include "halflight/scene/procedural/office.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/office_clutter.h"
#include "halflight/scene/procedural/office_equipment.h"
#include "halflight/scene/procedural/office_furniture.h"
#include "halflight/scene/procedural/potted_plant.h"

namespace halflight {
namespace {

// A workplace is kWorkplaceWidth along x and kRow along z: shelves at its z = 0, desk at z = kRow.
// Every second row is turned around, so that desks meet desks and shelves meet shelves.
constexpr float kWorkplaceWidth = 3.f;
constexpr float kRow = 3.4f;
constexpr float kCeiling = 2.9f;
constexpr int kShelvesEach = 2;
constexpr int kComfortable = 320;  // small things of one workplace

struct Plan {
  int rows = 2;
  int columns = 2;
  int workplaces() const { return rows * columns; }
  Bounds3f inside() const {
    return {
        Vec3(0.f),
        {kWorkplaceWidth * static_cast<float>(columns), kCeiling, kRow * static_cast<float>(rows)}};
  }
};
Plan plan_for(int count) {
  const int wanted = std::max(4, (count + kComfortable - 1) / kComfortable);
  Plan plan;
  plan.rows = 2 * std::max(1, static_cast<int>(std::lround(0.5 * std::sqrt(wanted))));
  plan.columns = (wanted + plan.rows - 1) / plan.rows;
  return plan;
}

struct Kit {
  OfficePalette palette;
  RoomMaterials room;
  Furniture furniture;
  Equipment equipment;
  SmallObjects objects;
  std::vector<MeshId> plants;
  MeshId light;
  MeshId wires;
};
Kit add_kit(Scene& scene, std::uint64_t seed) {
  Kit kit;
  kit.palette = add_office_palette(scene);
  kit.room = add_room_materials(scene, {0.24f, 0.26f, 0.28f}, {0.76f, 0.74f, 0.69f}, Rgb(0.8f));
  kit.furniture = add_furniture(scene, kit.palette);
  kit.equipment = add_equipment(scene, kit.palette);
  kit.objects = add_small_objects(scene, hash(seed, 10));
  const PlantMaterials green = add_plant_materials(scene);
  for (int i = 0; i < 2; ++i)
    kit.plants.push_back(add_plant(scene, green, PlantShape{}, hash(seed, 11, i)));
  kit.light =
      add_light_panel(scene, {1.5f, 0.24f, 0.05f}, kit.palette.tube, kit.palette.white_plastic);
  MeshParts wires;
  for (const float x : {-0.6f, 0.6f})
    append_rod(wires[kit.palette.steel], {x, 0.0505f, 0.f}, {x, 0.3495f, 0.f}, 0.003f, 6);
  kit.wires = add_mesh(scene, "wires", std::move(wires));
  return kit;
}

void equip_desk(Scene& scene, const Kit& kit, NodeId desk, Random& random) {
  const float y = kDeskTop + kContactGap;
  const auto put = [&](const char* name, MeshId mesh, float x, float z, float turn) {
    add_node(scene, name, mesh, placed_at({x, y, z}, turn), desk);
  };
  const Equipment& e = kit.equipment;
  put("monitor", e.monitor, 0.02f, -0.2f, random.uniform(-0.1f, 0.1f));
  put("keyboard", e.keyboard, 0.f, 0.2f, random.uniform(-0.05f, 0.05f));
  put("mouse", e.mouse, 0.32f, 0.2f, random.uniform(-0.2f, 0.2f));
  put("desk lamp", e.lamp, -0.62f, -0.24f, random.uniform(-0.2f, 0.3f));
  put("mug", e.mug, 0.45f, -0.05f, random.angle());
  put("pen cup", e.pen_cup, 0.66f, -0.2f, 0.f);
  put("phone", e.phone, 0.47f, -0.26f, random.uniform(-0.1f, 0.2f));
}

// Shares `count` as evenly as whole numbers allow: part i of n.
int share(int count, int i, int n) {
  const long all = count;
  return static_cast<int>(all * (i + 1) / n - all * i / n);
}

void add_workplace(Clutter& clutter, const Kit& kit, NodeId place, int count, Random& random) {
  Scene& scene = clutter.scene;
  // Turned around: the desk's user sits on the side of the shelves.
  const Vec3 desk_at(0.f, kContactGap, kRow - 0.04f - 0.5f * kDeskDepth);
  const NodeId desk = add_node(scene, "desk", kit.furniture.desk, placed_at(desk_at, kPi), place);
  equip_desk(scene, kit, desk, random);
  const int on_desk = std::min(count, kDeskObjects);
  clutter_desk(clutter, desk, on_desk, random);

  const Vec3 chair_at(random.uniform(-0.15f, 0.1f), kContactGap, desk_at.z - 0.72f);
  add_node(scene, "chair", kit.furniture.chair,
           placed_at(chair_at, kPi + random.uniform(-0.7f, 0.7f)), place);
  add_node(scene, "bin", kit.furniture.bin, placed_at({1.05f, kContactGap, desk_at.z + 0.1f}),
           place);
  if (random.uniform() < 0.6f) {
    const MeshId plant = kit.plants[static_cast<std::size_t>(random.below(2))];
    add_node(scene, "plant", plant, placed_at({-1.2f, kContactGap, 0.42f}, random.angle()), place);
  }
  const int boards = kShelvesEach * kShelfBoards;
  for (int unit = 0; unit < kShelvesEach; ++unit) {
    const Vec3 at(unit == 0 ? -0.3f : 0.705f, kContactGap, 0.5f * kShelfDepth + 0.02f);
    const NodeId shelf = add_node(scene, "shelf", kit.furniture.shelf, placed_at(at), place);
    for (int board = 0; board < kShelfBoards; ++board) {
      const int things = share(count - on_desk, unit * kShelfBoards + board, boards);
      fill_board(clutter, shelf, board, things, random);
    }
  }
}

// The light hangs over the chair, from two wires.
void add_light(Scene& scene, const Kit& kit, NodeId place) {
  const NodeId light =
      add_node(scene, "light", kit.light, placed_at({0.f, kCeiling - 0.35f, 2.2f}), place);
  add_node(scene, "wires", kit.wires, Mat4(1.0), light);
}

void add_walls(Scene& scene, const Kit& kit, const Plan& plan) {
  const Bounds3f inside = plan.inside();
  add_room(scene, inside, kit.room);
  const float left = kContactGap, right = inside.upper.x - kContactGap;
  for (int row = 0; row < plan.rows; ++row) {
    const float z = kRow * (static_cast<float>(row) + 0.5f);
    add_node(scene, "window", kit.furniture.window, placed_at({left, 0.f, z}, 0.5f * kPi));
    if (row > 0)
      add_node(scene, "whiteboard", kit.furniture.whiteboard,
               placed_at({right, 0.f, z}, -0.5f * kPi));
  }
  for (int row = 1; row < plan.rows; row += 2) {
    const Vec3 at(0.4f, kContactGap, kRow * static_cast<float>(row));
    add_node(scene, "plant", kit.plants[0], placed_at(at, static_cast<float>(row)));
  }
  const float first = 0.5f * kRow;
  add_node(scene, "door", kit.furniture.door, placed_at({right, kContactGap, first}, -0.5f * kPi));
  add_node(scene, "clock", kit.furniture.clock, placed_at({right, 0.f, kRow}, -0.5f * kPi));
}

}  // namespace

Knobs knobs(OfficeParameters& p) {
  return {{"count", "books, binders, pens, sheets and other small things", &p.count, 0, 1e6},
          {"seed", "what lies where", &p.seed, 0, 1e9}};
}

Scene office_scene(const OfficeParameters& p) {
  Scene scene;
  const std::uint64_t seed = static_cast<std::uint64_t>(p.seed);
  const Kit kit = add_kit(scene, seed);
  const Plan plan = plan_for(p.count);
  add_walls(scene, kit, plan);
  Clutter clutter{scene, kit.objects};
  for (int i = 0; i < plan.workplaces(); ++i) {
    const int row = i / plan.columns, column = i % plan.columns;
    const bool turned = row % 2 == 1;
    const Vec3 origin((static_cast<float>(column) + 0.5f) * kWorkplaceWidth, 0.f,
                      static_cast<float>(row + (turned ? 1 : 0)) * kRow);
    const NodeId place = add_group(scene, "workplace " + std::to_string(i + 1),
                                   placed_at(origin, turned ? kPi : 0.f));
    Random random(hash(seed, 12, i));
    add_workplace(clutter, kit, place, share(p.count, i, plan.workplaces()), random);
    add_light(scene, kit, place);
    if (!turned)
      add_node(scene, "divider", kit.furniture.divider, placed_at({0.f, 0.f, kRow}), place);
  }
  add_camera(scene, "desk", {5.3f, 1.7f, 0.75f}, {2.f, 0.85f, 4.f}, 0.95f);
  add_camera(scene, "shelves", {2.2f, 1.5f, 2.9f}, {1.6f, 1.f, 0.f}, 0.9f);
  return scene;
}

}  // namespace halflight
