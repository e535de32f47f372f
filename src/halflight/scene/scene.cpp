#include "halflight/scene/scene.h"

namespace halflight {

IdVector<NodeId, Mat4> global_transforms(const Scene& scene) {
  IdVector<NodeId, Mat4> global(scene.nodes.size(), Mat4(1.0));
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[NodeId(i)];
    global[NodeId(i)] = node.parent.valid() ? global[node.parent] * node.local : node.local;
  }
  return global;
}

}  // namespace halflight
