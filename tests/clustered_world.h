// Scenes of many small shapes with a cluster tree over their surfaces.
#pragma once

#include <memory>
#include <vector>

#include "halflight/base/hash.h"
#include "halflight/hierarchy/size_grid.h"
#include "halflight/rays/world.h"
#include "halflight/scene/procedural/assembly.h"

namespace halflight::testing {

// Repeatable random numbers for placing things.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}

  float number() { return to_unit_float(hash(seed_, count_++)); }
  float between(float low, float high) { return low + (high - low) * number(); }
  Vec3 point() {
    const float x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Vec3 point_in(const Bounds3f& box) { return box.lower + box.extent() * point(); }
  Vec3 direction() {
    const float z = between(-1.f, 1.f), phi = 2.f * kPi * number();
    const float r = std::sqrt(std::max(0.f, 1.f - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  // Turned about its normal as well.
  Frame frame() {
    const Vec3 n = direction();
    const Frame f = Frame::from_normal(n);
    const float phi = 2.f * kPi * number();
    const Vec3 t = std::cos(phi) * f.tangent + std::sin(phi) * f.bitangent;
    return {t, glm::cross(n, t), n};
  }

 private:
  std::uint64_t seed_, count_ = 0;
};

class ShapeScene {
 public:
  Scene scene;
  Primitive shapes;

  ShapeScene() { material_ = add_material(scene, "grey", Rgb(0.5f)); }
  Material& material() { return scene.materials[material_]; }

  void quad(const Vec3& center, const Vec3& half_u, const Vec3& half_v) {
    append_quad(shapes, {center - half_u - half_v, center + half_u - half_v,
                         center + half_u + half_v, center - half_u + half_v});
  }
  void disc(const Vec3& center, const Frame& frame, float radius, int corners) {
    for (int k = 0; k < corners; ++k) {
      const auto at = [&](int i) {
        const float phi = 2.f * kPi * static_cast<float>(i) / static_cast<float>(corners);
        return center + radius * (std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent);
      };
      append_triangle(shapes, center, at(k), at((k + 1) % corners));
    }
  }
  void cube(const Vec3& center, const Frame& frame, float edge) {
    // Sides share their corners to the last bit, so that the cube counts as closed.
    const auto corner = [&](int i) {
      return center +
             0.5f * edge *
                 ((i & 1 ? 1.f : -1.f) * frame.tangent + (i & 2 ? 1.f : -1.f) * frame.bitangent +
                  (i & 4 ? 1.f : -1.f) * frame.normal);
    };
    static constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& k : kSides)
      append_quad(shapes, {corner(k[0]), corner(k[1]), corner(k[2]), corner(k[3])});
  }
  // Hands over what has been drawn so far as one mesh; later shapes make another.
  void end_mesh() {
    if (shapes.triangles.empty()) return;
    MeshParts parts;
    parts[material_] = std::move(shapes);
    add_node(scene, "shapes", add_mesh(scene, "shapes", std::move(parts)));
    shapes = {};
  }

 private:
  MaterialId material_;
};

struct ClusteredWorld {
  World world;
  Surfaces surfaces;
  ClusterTree clusters;

  explicit ClusteredWorld(Scene scene)
      : world(std::move(scene)),
        surfaces(build_surfaces(world.geometry)),
        clusters(build_size_grid(boxes())) {}

  std::vector<Bounds3f> boxes() const {
    std::vector<Bounds3f> all;
    for (const Surface& s : surfaces.surfaces) all.push_back(s.box);
    return all;
  }
};

inline ClusteredWorld cluster(ShapeScene& shapes) {
  shapes.end_mesh();
  return ClusteredWorld(shapes.scene);
}

}  // namespace halflight::testing
