#include "halflight/io/gltf_parts.h"
#include "halflight/io/write_gltf.h"

namespace halflight {
namespace {

using nlohmann::json;

json material_json(const Material& m, TextureWriter& textures, GlbBuilder& glb) {
  json j = json::object();
  if (!m.name.empty()) j["name"] = m.name;
  json& pbr = j["pbrMetallicRoughness"];
  const Rgb c = glm::clamp(m.reflectance, Rgb(0.f), Rgb(1.f));
  pbr = {{"baseColorFactor", {c.r, c.g, c.b, std::clamp(m.alpha, 0.f, 1.f)}},
         {"metallicFactor", 0.0}};
  if (json texture = textures.base_color(m); !texture.is_null()) pbr["baseColorTexture"] = texture;
  if (m.alpha_mode == AlphaMode::blend) j["alphaMode"] = "BLEND";
  if (m.alpha_mode == AlphaMode::mask) {
    j["alphaMode"] = "MASK";
    j["alphaCutoff"] = m.alpha_cutoff;
  }
  if (m.double_sided) j["doubleSided"] = true;
  if (m.transmission > 0.f) {
    j["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = m.transmission;
    glb.use_extension("KHR_materials_transmission");
  }
  if (m.emits()) {
    // emissiveFactor may not pass 1: the rest is the strength.
    const float strength = std::max(1.f, max_component(m.emission));
    const Rgb e = m.emission / strength;
    j["emissiveFactor"] = {e.r, e.g, e.b};
    if (m.emission_texture.valid()) j["emissiveTexture"] = textures.info(m.emission_texture);
    if (strength > 1.f) {
      j["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
      glb.use_extension("KHR_materials_emissive_strength");
    }
  }
  return j;
}

json primitive_json(const Scene& scene, const Primitive& p, GlbBuilder& glb) {
  json j{{"material", p.material.value}};
  json& attributes = j["attributes"];
  attributes["POSITION"] = glb.add_positions(p.positions);
  if (!p.normals.empty()) attributes["NORMAL"] = glb.add_vectors(p.normals);
  // A set 1 without a set 0 is invalid, and so is a texture without its set: zeros fill the gap.
  const int needed = std::max(uv_sets_needed(scene.materials[p.material]),
                              p.uvs[1].empty() ? (p.uvs[0].empty() ? 0 : 1) : 2);
  const std::vector<Vec2> zeros(needed > 0 ? p.positions.size() : 0, Vec2(0.f));
  for (int set = 0; set < needed; ++set)
    attributes["TEXCOORD_" + std::to_string(set)] =
        glb.add_uvs(p.uvs[set].empty() ? zeros : p.uvs[set]);
  j["indices"] = glb.add_triangles(p.triangles, p.positions.size());
  return j;
}

// Index of the written mesh; -1 when it has no triangle (glTF allows no empty mesh).
int write_mesh(const Scene& scene, const Mesh& mesh, GlbBuilder& glb) {
  json primitives = json::array();
  for (const Primitive& p : mesh.primitives)
    if (!p.triangles.empty()) primitives.push_back(primitive_json(scene, p, glb));
  if (primitives.empty()) return -1;
  json j{{"primitives", std::move(primitives)}};
  if (!mesh.name.empty()) j["name"] = mesh.name;
  return glb.append("meshes", std::move(j));
}

// EXT_mesh_gpu_instancing; nothing when a copy's matrix is no translation-rotation-scale.
std::optional<json> instancing_json(const std::vector<Mat4>& copies, GlbBuilder& glb) {
  std::vector<Vec3> translations, scales;
  std::vector<Vec4> rotations;
  for (const Mat4& copy : copies) {
    const auto trs = decompose(copy);
    if (!trs) return std::nullopt;
    translations.push_back(Vec3(trs->translation));
    rotations.push_back({trs->rotation.x, trs->rotation.y, trs->rotation.z, trs->rotation.w});
    scales.push_back(Vec3(trs->scale));
  }
  glb.use_extension("EXT_mesh_gpu_instancing", true);
  return json{{"attributes",
               {{"TRANSLATION", glb.add_vectors(translations)},
                {"ROTATION", glb.add_quaternions(rotations)},
                {"SCALE", glb.add_vectors(scales)}}}};
}

json matrix_node(const Mat4& local, int mesh, GlbBuilder& glb) {
  json j = node_json(Node(), local, glb);
  j["mesh"] = mesh;
  return j;
}

}  // namespace

Result<void> write_scene_glb(const std::filesystem::path& path, const Scene& scene) {
  GlbBuilder glb;
  TextureWriter textures(scene, glb);
  for (const Material& m : scene.materials)
    glb.append("materials", material_json(m, textures, glb));
  std::vector<int> meshes;
  for (const Mesh& mesh : scene.meshes) meshes.push_back(write_mesh(scene, mesh, glb));
  write_cameras_and_lights(scene, glb);

  std::vector<json> nodes;
  json roots = json::array();
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[NodeId(i)];
    const bool is_root = !node.parent.valid();
    nodes.push_back(node_json(node, is_root ? scene.to_world * node.local : node.local, glb));
    if (is_root)
      roots.push_back(i);
    else
      nodes[node.parent.value]["children"].push_back(i);
  }
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[NodeId(i)];
    const int mesh = node.mesh.valid() ? meshes[node.mesh.value] : -1;
    if (mesh < 0) continue;
    const auto instancing =
        node.instances.empty() ? std::nullopt : instancing_json(node.instances, glb);
    if (instancing) nodes[i]["extensions"]["EXT_mesh_gpu_instancing"] = *instancing;
    if (instancing || node.instances.empty()) {
      nodes[i]["mesh"] = mesh;
      continue;
    }
    for (const Mat4& copy : node.instances) {
      nodes[i]["children"].push_back(nodes.size());
      nodes.push_back(matrix_node(copy, mesh, glb));
    }
  }
  if (!nodes.empty()) glb.document["nodes"] = std::move(nodes);
  json& root = glb.append("scenes", json::object()) == 0 ? glb.document["scenes"][0] : glb.document;
  if (!roots.empty()) root["nodes"] = std::move(roots);
  if (max_component(scene.sky) > 0.f)
    root["extras"]["sky"] = {scene.sky.r, scene.sky.g, scene.sky.b};
  glb.document["scene"] = 0;
  return glb.finish(path);
}

}  // namespace halflight
