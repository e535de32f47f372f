#include "halflight/io/placed_scene.h"

#include "halflight/io/scene_limits.h"

namespace halflight {

void check_placed_size(const Scene& scene, const std::string& where) {
  ReadBudget vertices("placed vertices", kMaxVertices);
  ReadBudget triangles("placed triangles", kMaxTriangles);
  ReadBudget instances("instances", kMaxInstances);
  for (const Node& node : scene.nodes) {
    if (!node.mesh.valid()) continue;
    const std::size_t copies = std::max<std::size_t>(1, node.instances.size());
    for (const Primitive& p : scene.meshes[node.mesh].primitives) {
      instances.take(copies, where);
      vertices.take(p.positions.size() * copies, where);
      triangles.take(p.triangles.size() * copies, where);
    }
  }
}

}  // namespace halflight
