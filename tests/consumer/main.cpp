// Uses the installed library: a triangle stands between two points, and nothing beside it.
#include <cstdio>

#include <halflight/rays/ray_scene.h>
#include <halflight/scene/geometry.h>

int main() {
  using namespace halflight;
  Scene scene;
  Primitive triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  triangle.material = scene.materials.push_back({});
  Mesh mesh;
  mesh.primitives.push_back(triangle);
  Node node;
  node.mesh = scene.meshes.push_back(mesh);
  scene.nodes.push_back(node);

  const Geometry geometry = flatten(scene);
  const RayScene rays(scene, geometry);
  const float through = rays.transmittance({0.2f, 0.2f, -1.f}, {0.2f, 0.2f, 1.f});
  const float beside = rays.transmittance({0.9f, 0.9f, -1.f}, {0.9f, 0.9f, 1.f});
  std::printf("through %g, beside %g\n", static_cast<double>(through), static_cast<double>(beside));
  return through == 0.f && beside == 1.f ? 0 : 1;
}
