// Small scenes of rectangles, for closed-form tests.
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "halflight/rays/path_tracer.h"
#include "halflight/rays/world.h"

namespace halflight::testing {

class QuadScene {
 public:
  Scene scene;

  MaterialId material(float reflectance, float radiance = 0.f, bool double_sided = false) {
    Material m;
    m.reflectance = Rgb(reflectance);
    m.emission = Rgb(radiance);
    m.double_sided = double_sided;
    return scene.materials.push_back(m);
  }
  // A pane that stops the share `opacity` of the light and reflects nothing.
  MaterialId pane(float opacity) {
    Material m;
    m.reflectance = Rgb(0.f);
    m.alpha_mode = AlphaMode::blend;
    m.alpha = opacity;
    return scene.materials.push_back(m);
  }
  // Corners a, a + u, a + u + v, a + v; the front faces cross(u, v).
  void quad(const Vec3& a, const Vec3& u, const Vec3& v, MaterialId material) {
    Primitive p;
    p.positions = {a, a + u, a + u + v, a + v};
    p.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    p.triangles = {{0, 1, 2}, {0, 2, 3}};
    p.material = material;
    add(p);
  }
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c, MaterialId material) {
    Primitive p;
    p.positions = {a, b, c};
    p.triangles = {{0, 1, 2}};
    p.material = material;
    add(p);
  }
  // A ball of `rings` x 2 rings cells; fronts inwards, or outwards. Above the height `lid`, rounded
  // to a ring, it is open.
  void ball(const Vec3& centre, float radius, MaterialId material, bool inwards, int rings = 24,
            float lid = kInfinity) {
    Primitive p;
    p.material = material;
    const int around = 2 * rings;
    for (int i = 0; i <= rings; ++i)
      for (int k = 0; k < around; ++k) {
        const double polar = std::acos(-1.0) * i / rings, turn = std::acos(-1.0) * k / rings;
        const double r = i == 0 || i == rings ? 0.0 : std::sin(polar);
        p.positions.push_back(centre + radius * Vec3(static_cast<float>(r * std::sin(turn)),
                                                     static_cast<float>(std::cos(polar)),
                                                     static_cast<float>(r * std::cos(turn))));
      }
    const auto face = [&](int a, int b, int c) {
      if (inwards) std::swap(b, c);
      p.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                             static_cast<std::uint32_t>(c)});
    };
    for (int i = 0; i < rings; ++i) {
      if (p.positions[static_cast<std::size_t>(i) * around].y > centre.y + lid + 1e-4f * radius)
        continue;
      for (int k = 0; k < around; ++k) {
        const int next = (k + 1) % around, top = i * around, bottom = top + around;
        if (i + 1 < rings) face(top + k, bottom + k, bottom + next);
        if (i > 0) face(top + k, bottom + next, top + next);
      }
    }
    add(p);
  }
  // The six sides of a box; fronts inwards, or outwards.
  void box(const Vec3& lower, const Vec3& upper, MaterialId material, bool inwards) {
    const Vec3 e = upper - lower;
    for (int k = 0; k < 3; ++k) {
      Vec3 u(0.f), v(0.f), w(0.f);
      u[(k + 1) % 3] = e[(k + 1) % 3];
      v[(k + 2) % 3] = e[(k + 2) % 3];
      w[k] = e[k];
      quad(lower, inwards ? u : v, inwards ? v : u, material);
      quad(lower + w, inwards ? v : u, inwards ? u : v, material);
    }
  }
  // Placed by a node whose -Z axis is turned to -Y: lamps shine straight down.
  void light_shining_down(const Light& light, const Vec3& position) {
    Node node;
    node.light = scene.lights.push_back(light);
    node.local = Mat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0),
                      glm::dvec4(position, 1));
    scene.nodes.push_back(node);
  }

 private:
  void add(const Primitive& p) {
    Mesh mesh;
    mesh.primitives.push_back(p);
    Node node;
    node.mesh = scene.meshes.push_back(mesh);
    scene.nodes.push_back(node);
  }
};

// A scene made ready for rays.
struct Traced : World {
  PathTracer tracer;

  explicit Traced(const QuadScene& quads) : World(quads.scene), tracer(*this) {}

  float irradiance(const Vec3& p, const Vec3& n, std::uint32_t samples = 1u << 14) const {
    return tracer.estimate_irradiance(p, n, samples, 7).mean.g;
  }
};

inline constexpr Vec3 kUp{0.f, 1.f, 0.f};
inline constexpr Vec3 kDown{0.f, -1.f, 0.f};

// Irradiance / (pi L) of a point that faces, at distance d, a rectangle parallel to it; the foot of
// the perpendicular is one corner, the sides are a and b (Siegel and Howell, configuration B-4).
inline float corner_form_factor(float a, float b, float d) {
  const float x = a / d, y = b / d;
  const float rx = std::sqrt(1.f + x * x), ry = std::sqrt(1.f + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.f * kPi);
}

}  // namespace halflight::testing
