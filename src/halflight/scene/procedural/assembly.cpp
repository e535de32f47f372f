#include "halflight/scene/procedural/assembly.h"

#include <utility>

#include <glm/ext/matrix_transform.hpp>

namespace halflight {

MaterialId add_material(Scene& scene, std::string name, const Rgb& reflectance) {
  Material material;
  material.name = std::move(name);
  material.reflectance = reflectance;
  return scene.materials.push_back(std::move(material));
}

MaterialId add_sheet_material(Scene& scene, std::string name, const Rgb& reflectance) {
  const MaterialId id = add_material(scene, std::move(name), reflectance);
  scene.materials[id].double_sided = true;
  return id;
}

MaterialId add_emitter(Scene& scene, std::string name, const Rgb& radiance,
                       const Rgb& reflectance) {
  const MaterialId id = add_material(scene, std::move(name), reflectance);
  scene.materials[id].emission = radiance;
  return id;
}

MeshId add_mesh(Scene& scene, std::string name, MeshParts&& parts) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (auto& [material, primitive] : parts) {
    mesh.primitives.push_back(std::move(primitive));
    mesh.primitives.back().material = material;
  }
  return scene.meshes.push_back(std::move(mesh));
}

Mat4 placed_at(const Vec3& position, float turn, const Vec3& scale) {
  const Mat4 moved = glm::translate(Mat4(1.0), glm::dvec3(position));
  const Mat4 turned = glm::rotate(moved, static_cast<double>(turn), glm::dvec3(0.0, 1.0, 0.0));
  return glm::scale(turned, glm::dvec3(scale));
}

NodeId add_node(Scene& scene, std::string name, MeshId mesh, const Mat4& local, NodeId parent) {
  Node node;
  node.name = std::move(name);
  node.mesh = mesh;
  node.local = local;
  node.parent = parent;
  return scene.nodes.push_back(std::move(node));
}

NodeId add_group(Scene& scene, std::string name, const Mat4& local, NodeId parent) {
  return add_node(scene, std::move(name), MeshId(), local, parent);
}

NodeId add_camera(Scene& scene, std::string name, const Vec3& eye, const Vec3& target,
                  float vertical_fov) {
  Camera camera;
  camera.name = name;
  camera.vertical_fov = vertical_fov;
  const Mat4 from_world =
      glm::lookAt(glm::dvec3(eye), glm::dvec3(target), glm::dvec3(0.0, 1.0, 0.0));
  const NodeId node = add_node(scene, std::move(name), MeshId(), glm::inverse(from_world));
  scene.nodes[node].camera = scene.cameras.push_back(std::move(camera));
  return node;
}

RoomMaterials add_room_materials(Scene& scene, const Rgb& floor, const Rgb& walls,
                                 const Rgb& ceiling) {
  RoomMaterials materials;
  materials.floor = add_material(scene, "floor", floor);
  materials.walls = add_material(scene, "walls", walls);
  materials.ceiling = add_material(scene, "ceiling", ceiling);
  return materials;
}

NodeId add_room(Scene& scene, const Bounds3f& inside, const RoomMaterials& materials) {
  MeshParts parts;
  for (const Side side : kAllSides) {
    const MaterialId material = side == Side::y_low    ? materials.floor
                                : side == Side::y_high ? materials.ceiling
                                                       : materials.walls;
    append_quad(parts[material], side_of(inside, side, Facing::inwards));
  }
  return add_node(scene, "room", add_mesh(scene, "room", std::move(parts)));
}

MeshId add_light_panel(Scene& scene, const LightPanel& panel, MaterialId emitter,
                       MaterialId housing) {
  const Bounds3f box{{-0.5f * panel.width, 0.f, -0.5f * panel.depth},
                     {0.5f * panel.width, panel.thickness, 0.5f * panel.depth}};
  MeshParts parts;
  for (const Side side : kAllSides)
    append_quad(parts[side == Side::y_low ? emitter : housing], side_of(box, side));
  return add_mesh(scene, "light panel", std::move(parts));
}

}  // namespace halflight
