#include "halflight/io/gltf_nodes.h"

#include <glm/gtc/quaternion.hpp>

#include "halflight/io/gltf_accessors.h"
#include "halflight/io/gltf_fixtures.h"

namespace halflight {
namespace {

constexpr std::uint32_t kNoParent = NodeId::kInvalid;

// Parent of every node. Each node has at most one, and following parents ends.
std::vector<std::uint32_t> node_parents(const JsonCursor& root) {
  const std::size_t n = array_size(root, "nodes");
  std::vector<std::uint32_t> parents(n, kNoParent);
  for (std::size_t i = 0; i < n; ++i) {
    const auto children = root.at("nodes")[i].find("children");
    if (!children) continue;
    for (std::size_t k = 0; k < children->size(); ++k) {
      const JsonCursor child = (*children)[k];
      std::uint32_t& parent = parents[child.index_below(n, "node")];
      if (parent != kNoParent)
        child.fail("node " + std::to_string(child.count()) + " has two parents");
      parent = static_cast<std::uint32_t>(i);
    }
  }
  return parents;
}

// Nodes below `roots`, parents before children. An explicit stack: depth is the file's choice.
std::vector<std::size_t> below(const JsonCursor& root, std::vector<std::size_t> roots) {
  std::vector<std::size_t> order;
  std::vector<std::size_t> stack(roots.rbegin(), roots.rend());
  while (!stack.empty()) {
    const std::size_t node = stack.back();
    stack.pop_back();
    order.push_back(node);
    const auto children = root.at("nodes")[node].find("children");
    for (std::size_t k = children ? children->size() : 0; k-- > 0;)
      stack.push_back((*children)[k].count());
  }
  return order;
}

std::vector<std::size_t> all_roots(const std::vector<std::uint32_t>& parents) {
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (parents[i] == kNoParent) roots.push_back(i);
  return roots;
}

std::vector<std::size_t> scene_roots(const JsonCursor& root,
                                     const std::vector<std::uint32_t>& parents,
                                     ReadWarnings& warnings) {
  const std::size_t scenes = array_size(root, "scenes");
  const auto chosen = root.find("scene");
  if (scenes == 0 && !chosen) {
    warnings.add(root.path() + ": there is no scene in it; every node is shown");
    return all_roots(parents);
  }
  const JsonCursor scene = root.at("scenes")[chosen ? chosen->index_below(scenes, "scene") : 0];
  std::vector<std::size_t> roots;
  std::vector<bool> listed(parents.size());
  for (std::size_t i = 0; i < array_size(scene, "nodes"); ++i) {
    const JsonCursor entry = scene.at("nodes")[i];
    const std::size_t node = entry.index_below(parents.size(), "node");
    if (parents[node] != kNoParent || listed[node])
      entry.fail("node " + std::to_string(node) + " is not a root of its own");
    listed[node] = true;
    roots.push_back(node);
  }
  return roots;
}

Mat4 from_parts(const Vec3& translation, const std::array<float, 4>& rotation, const Vec3& scale) {
  const glm::dvec4 q(rotation[0], rotation[1], rotation[2], rotation[3]);
  const double length = glm::length(q);
  const glm::dvec4 unit = length > 0.0 ? q / length : glm::dvec4(0.0, 0.0, 0.0, 1.0);
  Mat4 m = glm::mat4_cast(glm::dquat(unit.w, unit.x, unit.y, unit.z));
  for (int k = 0; k < 3; ++k) m[k] *= static_cast<double>(scale[k]);
  m[3] = glm::dvec4(translation.x, translation.y, translation.z, 1.0);
  return m;
}

Mat4 local_transform(const JsonCursor& node) {
  std::array<float, 16> numbers{};
  if (node.read_numbers("matrix", 16, numbers)) {
    if (numbers[3] != 0.f || numbers[7] != 0.f || numbers[11] != 0.f || numbers[15] != 1.f)
      node.at("matrix").fail("the last row of the matrix should be 0 0 0 1");
    Mat4 m(1.0);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        m[column][row] = static_cast<double>(
            numbers[4 * static_cast<std::size_t>(column) + static_cast<std::size_t>(row)]);
    return m;
  }
  Vec3 translation(0.f), scale(1.f);
  std::array<float, 4> rotation{0.f, 0.f, 0.f, 1.f};
  node.read_numbers("translation", 3, translation);
  node.read_numbers("rotation", 4, rotation);
  node.read_numbers("scale", 3, scale);
  return from_parts(translation, rotation, scale);
}

// EXT_mesh_gpu_instancing.
std::vector<Mat4> read_instances(GltfDocument& document, const JsonCursor& extension,
                                 ReadBudget& budget) {
  const JsonCursor attributes = extension.at("attributes");
  const auto translation = attributes.find("TRANSLATION"), rotation = attributes.find("ROTATION"),
             scale = attributes.find("SCALE");
  std::size_t count = 0;
  for (const auto& attribute : {translation, rotation, scale}) {
    if (!attribute) continue;
    const std::size_t n = accessor_type(document.element("accessors", *attribute)).count;
    if (count != 0 && n != count) attribute->fail("the instance attributes differ in number");
    count = n;
  }
  if (count == 0) extension.fail("there are no instances");
  budget.take(count, extension.path());
  const auto read = [&](const auto& attribute, int components) {
    return attribute ? read_floats(document, *attribute, components) : std::vector<float>();
  };
  const std::vector<float> t = read(translation, 3), r = read(rotation, 4), s = read(scale, 3);
  std::vector<Mat4> instances(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 shift = t.empty() ? Vec3(0.f) : Vec3(t[3 * i], t[3 * i + 1], t[3 * i + 2]);
    const Vec3 size = s.empty() ? Vec3(1.f) : Vec3(s[3 * i], s[3 * i + 1], s[3 * i + 2]);
    std::array<float, 4> turn{0.f, 0.f, 0.f, 1.f};
    if (!r.empty()) turn = {r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]};
    instances[i] = from_parts(shift, turn, size);
  }
  return instances;
}

}  // namespace

void read_gltf_nodes(GltfDocument& document, GltfMeshes& meshes, Scene& scene,
                     ReadWarnings& warnings) {
  const JsonCursor root = document.root();
  const std::vector<std::uint32_t> parents = node_parents(root);
  if (below(root, all_roots(parents)).size() != parents.size())
    root.at("nodes").fail("the nodes form a circle");
  GltfFixtures fixtures(document, scene);
  ReadBudget instances("instances", kMaxInstances);
  std::vector<NodeId> id_of_node(parents.size());
  for (const std::size_t i : below(root, scene_roots(root, parents, warnings))) {
    const JsonCursor json = root.at("nodes")[i];
    Node node;
    node.name = json.name();
    if (parents[i] != kNoParent) node.parent = id_of_node[parents[i]];
    node.local = local_transform(json);
    if (const auto mesh = json.find("mesh")) node.mesh = meshes.read(*mesh);
    if (const auto camera = json.find("camera")) node.camera = fixtures.camera(*camera);
    if (const auto light = json.extension("KHR_lights_punctual"))
      node.light = fixtures.light(light->at("light"));
    const auto instancing = json.extension("EXT_mesh_gpu_instancing");
    if (instancing && node.mesh.valid())
      node.instances = read_instances(document, *instancing, instances);
    id_of_node[i] = scene.nodes.push_back(std::move(node));
  }
}

}  // namespace halflight
