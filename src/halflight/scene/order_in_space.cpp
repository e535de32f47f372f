#include "halflight/scene/order_in_space.h"

#include "halflight/base/morton_order.h"

namespace halflight {
namespace {

constexpr std::size_t kLarge = 1 << 15;  // triangles; fewer fit into a processor's cache

std::vector<std::uint32_t> triangle_order(const Primitive& p) {
  Bounds3f bounds;
  for (const Vec3& v : p.positions)
    if (is_finite(v)) bounds.extend(v);
  return order_along_curve(p.triangles.size(), bounds, [&](std::size_t i) {
    Bounds3f box;
    for (const std::uint32_t corner : p.triangles[i]) box.extend(p.positions[corner]);
    const Vec3 center = box.center();
    return is_finite(center) ? center : bounds.lower;
  });
}

// Renumbers the corners; vertices that no triangle uses come last.
std::vector<std::uint32_t> number_vertices(Primitive& p) {
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> order, number(p.positions.size(), kNone);
  order.reserve(number.size());
  const auto number_of = [&](std::uint32_t vertex) {
    if (number[vertex] == kNone) {
      number[vertex] = static_cast<std::uint32_t>(order.size());
      order.push_back(vertex);
    }
    return number[vertex];
  };
  for (auto& corners : p.triangles)
    for (std::uint32_t& corner : corners) corner = number_of(corner);
  for (std::uint32_t vertex = 0; vertex < number.size(); ++vertex) number_of(vertex);
  return order;
}

void order_in_space(Primitive& p) {
  arrange(p.triangles, triangle_order(p));
  const std::vector<std::uint32_t> vertices = number_vertices(p);
  arrange(p.positions, vertices);
  if (!p.normals.empty()) arrange(p.normals, vertices);
  for (auto& uvs : p.uvs)
    if (!uvs.empty()) arrange(uvs, vertices);
}

}  // namespace

void order_in_space(Scene& scene) {
  for (Mesh& mesh : scene.meshes)
    for (Primitive& p : mesh.primitives)
      if (p.triangles.size() >= kLarge) order_in_space(p);
}

}  // namespace halflight
