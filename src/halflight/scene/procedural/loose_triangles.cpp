#include "halflight/scene/procedural/loose_triangles.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/random.h"

namespace halflight {
namespace {

constexpr Bounds3f kRoom{{-2.f, 0.f, -2.f}, {2.f, 3.f, 2.f}};
constexpr float kLightHeight = 2.85f;

// Centres and directions are uniform; the clutter keeps clear of walls and light.
MeshParts clutter(const LooseTrianglesParameters& p, std::span<const MaterialId> materials) {
  const float reach = p.size / std::sqrt(3.f);  // circumradius
  const Vec3 upper(kRoom.upper.x, kLightHeight, kRoom.upper.z);
  const Bounds3f centers{kRoom.lower + Vec3(1.01f * reach), upper - Vec3(1.01f * reach)};
  Random random(hash(static_cast<std::uint64_t>(p.seed), 0));
  MeshParts parts;
  for (int i = 0; i < p.count; ++i) {
    const Vec3 center = random.point_in(centers);
    const Frame frame = Frame::from_normal(random.direction());
    const float turn = random.angle();
    std::array<Vec3, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const float phi = turn + 2.f * kPi / 3.f * static_cast<float>(k);
      corners[k] = center + reach * frame.to_world({std::cos(phi), std::sin(phi), 0.f});
    }
    Primitive& primitive = parts[materials[random.below(static_cast<int>(materials.size()))]];
    append_triangle(primitive, corners[0], corners[1], corners[2]);
  }
  return parts;
}

}  // namespace

Knobs knobs(LooseTrianglesParameters& p) {
  return {{"count", "number of loose triangles", &p.count, 0, 2e7},
          {"size", "side of a triangle, metres", &p.size, 0.001, 1},
          {"seed", "where they are", &p.seed, 0, 1e9}};
}

Scene loose_triangles_scene(const LooseTrianglesParameters& p) {
  Scene scene;
  const RoomMaterials room = add_room_materials(scene, Rgb(0.3f), {0.75f, 0.73f, 0.7f}, Rgb(0.8f));
  add_room(scene, kRoom, room);
  const std::array materials{
      add_sheet_material(scene, "ochre", {0.62f, 0.42f, 0.14f}),
      add_sheet_material(scene, "teal", {0.12f, 0.42f, 0.4f}),
      add_sheet_material(scene, "brick", {0.5f, 0.16f, 0.1f}),
      add_sheet_material(scene, "white", Rgb(0.75f)),
  };
  const MeshId triangles = add_mesh(scene, "loose triangles", clutter(p, materials));
  if (p.count > 0) add_node(scene, "loose triangles", triangles);
  const MaterialId light = add_emitter(scene, "light", {20.f, 18.f, 16.f}, Rgb(0.5f));
  const MeshId panel = add_light_panel(scene, {1.f, 1.f, 0.05f}, light, room.ceiling);
  add_node(scene, "ceiling light", panel, placed_at({0.f, kLightHeight, 0.f}));
  add_camera(scene, "corner", {1.9f, 1.6f, 1.9f}, {0.f, 1.2f, 0.f}, 1.1f);
  return scene;
}

}  // namespace halflight
