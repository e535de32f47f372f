// Putting built-in scenes together: materials, meshes of several materials, nodes, cameras, rooms.
#pragma once

#include <map>
#include <string>

#include "halflight/scene/procedural/shapes.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Gap between things that touch, in metres: no two surfaces of a scene lie in the same place.
inline constexpr float kContactGap = 0.0005f;

MaterialId add_material(Scene& scene, std::string name, const Rgb& reflectance);
// Lit and seen from both sides: leaves, sheets of paper.
MaterialId add_sheet_material(Scene& scene, std::string name, const Rgb& reflectance);
// Emits radiance L from its front side only.
MaterialId add_emitter(Scene& scene, std::string name, const Rgb& radiance, const Rgb& reflectance);

// The primitives of one mesh, one for each material.
using MeshParts = std::map<MaterialId, Primitive>;
MeshId add_mesh(Scene& scene, std::string name, MeshParts&& parts);

// Moves to `position` after turning by `turn` radians about +Y and scaling.
Mat4 placed_at(const Vec3& position, float turn = 0.f, const Vec3& scale = Vec3(1.f));
NodeId add_node(Scene& scene, std::string name, MeshId mesh, const Mat4& local = Mat4(1.0),
                NodeId parent = {});
NodeId add_group(Scene& scene, std::string name, const Mat4& local = Mat4(1.0), NodeId parent = {});
// A perspective camera at `eye` that looks at `target`; vertical field of view in radians.
NodeId add_camera(Scene& scene, std::string name, const Vec3& eye, const Vec3& target,
                  float vertical_fov);

struct RoomMaterials {
  MaterialId floor, walls, ceiling;
};
RoomMaterials add_room_materials(Scene& scene, const Rgb& floor, const Rgb& walls,
                                 const Rgb& ceiling);
// Closed empty box room seen from inside.
NodeId add_room(Scene& scene, const Bounds3f& inside, const RoomMaterials& materials);

// A flat closed box of width x thickness x depth whose lower side, centred at the origin, emits.
struct LightPanel {
  float width = 1.2f;
  float depth = 0.3f;
  float thickness = 0.05f;
};
MeshId add_light_panel(Scene& scene, const LightPanel& panel, MaterialId emitter,
                       MaterialId housing);

}  // namespace halflight
