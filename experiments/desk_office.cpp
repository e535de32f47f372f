#include "experiments/desk_office.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/office_clutter.h"
#include "halflight/scene/procedural/office_equipment.h"
#include "halflight/scene/procedural/office_furniture.h"

namespace halflight::experiments {
namespace {

constexpr Vec3 kRoom{6.f, 2.9f, 6.8f};
constexpr int kThingsOnDesk = 6;
constexpr int kAlongDesk = 6, kAcrossDesk = 4;  // places under each

struct DeskPlace {
  float x, z;
};
constexpr DeskPlace kDesks[] = {{1.5f, 1.7f}, {4.5f, 1.7f}, {1.5f, 5.1f}, {4.5f, 5.1f}};

void add_lights(DeskOffice& office, MaterialId tube) {
  for (const DeskPlace& at : kDesks) {
    const CeilingLight light{{at.x, kRoom.y - 0.05f, at.z}, {0.75f, 0.12f}};
    const Vec3 c = light.center, u(light.half.x, 0.f, 0.f), v(0.f, 0.f, light.half.y);
    MeshParts parts;
    append_quad(parts[tube], {c - u - v, c + u - v, c + u + v, c - u + v});
    add_node(office.scene, "light", add_mesh(office.scene, "light", std::move(parts)));
    office.lights.push_back(light);
  }
}

void add_desk_with_things(DeskOffice& office, const Furniture& furniture,
                          const Equipment& equipment, const SmallObjects& objects,
                          const DeskPlace& at, Random& random) {
  Scene& scene = office.scene;
  const NodeId desk = add_node(scene, "desk", furniture.desk, placed_at({at.x, kContactGap, at.z}));
  const auto put = [&](MeshId mesh, float x, float z) {
    add_node(scene, scene.meshes[mesh].name, mesh,
             placed_at({x, kDeskTop + kContactGap, z}, random.uniform(-0.1f, 0.1f)), desk);
  };
  put(equipment.monitor, 0.f, -0.2f);
  put(equipment.keyboard, 0.f, 0.2f);
  put(equipment.mouse, 0.32f, 0.2f);
  Clutter clutter{scene, objects};
  clutter_desk(clutter, desk, kThingsOnDesk, random);
  // Beside the desk, so that the chair does not stand where shadows are measured.
  add_node(scene, "chair", furniture.chair,
           placed_at({at.x, kContactGap, at.z + 0.95f}, random.uniform(-0.7f, 0.7f)));
  for (int i = 0; i < kAlongDesk; ++i)
    for (int j = 0; j < kAcrossDesk; ++j) {
      const Vec2 place((static_cast<float>(i) + 0.5f) / kAlongDesk,
                       (static_cast<float>(j) + 0.5f) / kAcrossDesk);
      office.under_desks.push_back(
          {at.x - 0.6f + 0.8f * place.x, 0.f, at.z - 0.25f + 0.5f * place.y});
    }
}

}  // namespace

DeskOffice desk_office() {
  DeskOffice office;
  const OfficePalette palette = add_office_palette(office.scene);
  const RoomMaterials room =
      add_room_materials(office.scene, {0.24f, 0.26f, 0.28f}, {0.76f, 0.74f, 0.69f}, Rgb(0.8f));
  add_room(office.scene, {Vec3(0.f), kRoom}, room);
  add_lights(office, palette.tube);
  const Furniture furniture = add_furniture(office.scene, palette);
  const Equipment equipment = add_equipment(office.scene, palette);
  const SmallObjects objects = add_small_objects(office.scene, 7);
  Random random(1);
  for (const DeskPlace& at : kDesks)
    add_desk_with_things(office, furniture, equipment, objects, at, random);
  for (const float x : {1.8f, 4.2f})
    add_node(office.scene, "shelf", furniture.shelf, placed_at({x, kContactGap, 0.2f}));
  add_camera(office.scene, "desks", {5.7f, 1.9f, 0.6f}, {2.4f, 0.4f, 4.2f}, 0.95f);
  return office;
}

}  // namespace halflight::experiments
