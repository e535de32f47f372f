#include <map>

#include <glm/matrix.hpp>

#include "halflight/base/parallel.h"
#include "halflight/io/gltf_parts.h"
#include "halflight/io/lit_material.h"
#include "halflight/io/write_gltf.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr std::size_t kGrain = 4096;

// Where the nodes lie in the output: `local` can be stored in glTF, `world` follows from it.
struct PlacedNodes {
  std::vector<Mat4> local, world;
};

// The rotation and position of m, for nodes that glTF cannot place otherwise (skewed or flat).
// Cameras and lights keep their place and direction; geometry is stored relative to the result.
Mat4 without_skew(const Mat4& m) {
  const glm::dvec3 z(m[2]), y(m[1]);
  const glm::dvec3 side = glm::cross(y, z);
  Mat4 rigid(1.0);
  if (glm::length(z) > 0.0 && glm::length(side) > 0.0) {
    const glm::dvec3 unit_z = glm::normalize(z), unit_x = glm::normalize(side);
    rigid[0] = glm::dvec4(unit_x, 0.0);
    rigid[1] = glm::dvec4(glm::cross(unit_z, unit_x), 0.0);
    rigid[2] = glm::dvec4(unit_z, 0.0);
  }
  rigid[3] = m[3];
  return rigid;
}

// Numbers that a file can hold and a reader add up. Nothing is lit beyond, but nodes may lie there.
bool can_be_stored(const Mat4& m) {
  constexpr double kFarthestNode = 1e30;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::abs(m[column][row]) < kFarthestNode)) return false;
  return true;
}

PlacedNodes place_nodes(const Scene& scene) {
  const auto global = global_transforms(scene);
  PlacedNodes placed;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[NodeId(i)];
    const Mat4 parent = node.parent.valid() ? placed.world[node.parent.value] : Mat4(1.0);
    const bool parent_as_read =
        !node.parent.valid() || parent == scene.to_world * global[node.parent];
    Mat4 local = node.local;
    if (!node.parent.valid())
      local = scene.to_world * node.local;
    else if (!parent_as_read)
      local = glm::inverse(parent) * (scene.to_world * global[NodeId(i)]);
    if (!decompose(local)) local = without_skew(local);
    if (!can_be_stored(local) || !can_be_stored(parent * local)) local = Mat4(1.0);
    placed.local.push_back(local);
    placed.world.push_back(parent * local);
  }
  return placed;
}

// The primitive's vertices in the space of a node. A mirroring node turns the winding round.
struct LocalShape {
  std::vector<Vec3> positions, normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

LocalShape to_local(const LitPrimitive& p, const Mat4& world) {
  const Mat4 inverse = glm::inverse(world);
  const Mat4 transposed = glm::transpose(world);  // inverse transpose of the inverse
  LocalShape local;
  local.positions.resize(p.positions.size());
  local.normals.resize(p.normals.size());
  parallel_for(p.positions.size(), kGrain, [&](std::size_t i) {
    local.positions[i] = transform_point(inverse, p.positions[i]);
    const Vec3 n = transform_vector(transposed, p.normals[i]);
    const float length = glm::length(n);
    local.normals[i] = length > 0.f ? n / length : Vec3(0.f, 1.f, 0.f);
  });
  local.triangles = p.triangles;
  if (glm::determinant(glm::dmat3(world)) < 0.0)
    for (auto& t : local.triangles) std::swap(t[1], t[2]);
  return local;
}

// Everything the pieces of the file need to be written.
struct LitFile {
  const Scene& scene;
  const Geometry& geometry;
  float exposure;
  bool has_lightmap = false;
  GlbBuilder glb{};
  TextureWriter textures{scene, glb};
  std::map<std::pair<MaterialId, bool>, std::pair<int, LitMaterial>> materials{};
};

// The set of texture coordinates for the lightmap: the first after those that textures need, and
// not the first of all.
int lightmap_set(const Material& m) { return std::max(1, uv_sets_needed(m)); }

const std::pair<int, LitMaterial>& material_of(LitFile& file, MaterialId id, bool back) {
  const Material& m = file.scene.materials[id];
  const bool emits = m.emits() && (!back || m.double_sided);
  auto entry = file.materials.find({id, emits});
  if (entry != file.materials.end()) return entry->second;
  LitMaterial lit = lit_material(m, emits, file.exposure, file.textures);
  file.glb.use_extension("KHR_materials_unlit");
  if (file.has_lightmap && lightmap_set(m) != 1)
    lit.json["extras"]["lightmap"]["texCoord"] = lightmap_set(m);
  const int index = file.glb.append("materials", lit.json);
  return file.materials.emplace(std::pair{id, emits}, std::pair{index, std::move(lit)})
      .first->second;
}

std::vector<Vec3> vertex_colors(const LitPrimitive& p, const LitMaterial& m, float exposure) {
  std::vector<Vec3> colors(p.irradiance.size());
  parallel_for(colors.size(), kGrain, [&](std::size_t i) {
    const Rgb shown = m.irradiance_weight * p.irradiance[i] / kPi + m.emission;
    colors[i] = glm::clamp(exposure * shown, Rgb(0.f), Rgb(1.f));
  });
  return colors;
}

json primitive_json(LitFile& file, const LitPrimitive& p, const Mat4& world) {
  const PrimitiveInstance& what = file.geometry.primitive_instances[p.instance];
  const MaterialId id = file.scene.meshes[what.mesh].primitives[what.primitive].material;
  const auto& [material, lit] = material_of(file, id, p.back);
  const LocalShape local = to_local(p, world);
  GlbBuilder& glb = file.glb;
  json attributes{{"POSITION", glb.add_positions(local.positions)},
                  {"NORMAL", glb.add_vectors(local.normals)},
                  {"COLOR_0", glb.add_vectors(vertex_colors(p, lit, file.exposure))},
                  {"_IRRADIANCE", glb.add_vectors(p.irradiance)}};
  // A set 1 without a set 0 is invalid, and so is a texture without its set: zeros fill the gap.
  const Material& source = file.scene.materials[id];
  const bool has_lightmap = !p.lightmap_uvs.empty();
  const int present = p.uvs[1].empty() ? (p.uvs[0].empty() ? 0 : 1) : 2;
  const int needed =
      has_lightmap ? lightmap_set(source) : std::max(present, uv_sets_needed(source));
  const std::vector<Vec2> zeros(needed > 0 ? p.positions.size() : 0, Vec2(0.f));
  for (int set = 0; set < needed; ++set)
    attributes["TEXCOORD_" + std::to_string(set)] =
        glb.add_uvs(p.uvs[set].empty() ? zeros : p.uvs[set]);
  if (has_lightmap) attributes["TEXCOORD_" + std::to_string(needed)] = glb.add_uvs(p.lightmap_uvs);
  return {{"attributes", std::move(attributes)},
          {"indices", glb.add_triangles(local.triangles, local.positions.size())},
          {"material", material}};
}

// Lit primitives by node and copy: one output mesh each.
using MeshParts = std::map<std::pair<NodeId, std::uint32_t>, std::vector<const LitPrimitive*>>;

MeshParts group_by_node(const Geometry& geometry, const std::vector<LitPrimitive>& primitives) {
  MeshParts parts;
  for (const LitPrimitive& p : primitives) {
    if (p.triangles.empty()) continue;
    const PrimitiveInstance& what = geometry.primitive_instances[p.instance];
    parts[{what.node, what.copy}].push_back(&p);
  }
  return parts;
}

int write_mesh(LitFile& file, const std::vector<const LitPrimitive*>& parts, const Mat4& world) {
  json mesh;
  for (const LitPrimitive* p : parts) mesh["primitives"].push_back(primitive_json(file, *p, world));
  const MeshId id = file.geometry.primitive_instances[parts.front()->instance].mesh;
  if (const std::string& name = file.scene.meshes[id].name; !name.empty()) mesh["name"] = name;
  return file.glb.append("meshes", std::move(mesh));
}

// The copies of an instanced node become child nodes: light differs from copy to copy.
json write_nodes(LitFile& file, const std::vector<LitPrimitive>& primitives, json& roots) {
  const PlacedNodes placed = place_nodes(file.scene);
  std::vector<json> nodes;
  for (std::size_t i = 0; i < file.scene.nodes.size(); ++i) {
    const Node& node = file.scene.nodes[NodeId(i)];
    nodes.push_back(node_json(node, placed.local[i], file.glb));
    if (node.parent.valid())
      nodes[node.parent.value]["children"].push_back(i);
    else
      roots.push_back(i);
  }
  for (const auto& [place, parts] : group_by_node(file.geometry, primitives)) {
    const auto& [id, copy] = place;
    const Node& node = file.scene.nodes[id];
    if (node.instances.empty()) {
      nodes[id.value]["mesh"] = write_mesh(file, parts, placed.world[id.value]);
      continue;
    }
    const Mat4& wanted = node.instances[copy];
    const Mat4 local = decompose(wanted) ? wanted : without_skew(wanted);
    json child = node_json(Node(), local, file.glb);
    child["mesh"] = write_mesh(file, parts, placed.world[id.value] * local);
    nodes[id.value]["children"].push_back(nodes.size());
    nodes.push_back(std::move(child));
  }
  return nodes;
}

Result<void> check(const std::vector<LitPrimitive>& primitives, const std::filesystem::path& path) {
  for (const LitPrimitive& p : primitives)
    for (std::size_t i = 0; i < p.positions.size(); ++i)
      if (!is_finite(p.positions[i]) || !is_finite(p.irradiance[i]))
        return system_error("a vertex has no finite position or irradiance", path.string(),
                            "please report this scene");
  return {};
}

}  // namespace

Result<void> write_lit_glb(const std::filesystem::path& path, const Scene& scene,
                           const Geometry& geometry, const std::vector<LitPrimitive>& primitives,
                           float exposure, const LightmapFile& lightmap) {
  if (auto ok = check(primitives, path); !ok) return ok;
  LitFile file{.scene = scene,
               .geometry = geometry,
               .exposure = exposure,
               .has_lightmap = !lightmap.name.empty()};
  write_cameras_and_lights(scene, file.glb);
  json roots = json::array();
  json nodes = write_nodes(file, primitives, roots);
  json extras{{"exposure", exposure},
              {"color_0", "clamp(exposure * irradiance / pi), emission included"},
              {"irradiance", "_IRRADIANCE, per vertex, linear"}};
  if (file.has_lightmap)
    extras["lightmap"] = {{"uri", lightmap.name},
                          {"size", lightmap.size},
                          {"texCoord", 1},
                          {"texels", "irradiance, linear, not divided by pi"}};
  json root{{"extras", extras}};
  if (!roots.empty()) {
    root["nodes"] = std::move(roots);
    file.glb.document["nodes"] = std::move(nodes);
  }
  file.glb.document["asset"]["extras"] = extras;
  file.glb.append("scenes", std::move(root));
  file.glb.document["scene"] = 0;
  return file.glb.finish(path);
}

}  // namespace halflight
