#include "halflight/scene/geometry.h"

#include <glm/matrix.hpp>

namespace halflight {
namespace {

// Of twice a triangle's area, m^4. Below, squares and products of areas and normals are flushed to
// 0 somewhere.
constexpr float kLeastSquaredArea = 1e-30f;

bool usable(const Vec3& p) {  // false for what is not a number, too
  return glm::all(glm::lessThanEqual(glm::abs(p), Vec3(kFarthest)));
}

// Where the node turns an axis, unit; zero where it leaves it no length.
Vec3 turned(const Mat4& world, const glm::dvec3& axis) {
  const glm::dvec3 v = glm::dmat3(world) * axis;
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0.0) || !is_finite(Vec3(v / largest))) return Vec3(0.f);
  return Vec3(glm::normalize(v / largest));
}

void append_instance(const Scene& scene, const PrimitiveInstance& what, const Mat4& world,
                     Geometry& g) {
  const Primitive& p = scene.meshes[what.mesh].primitives[what.primitive];
  const Mat4 normal_matrix = glm::transpose(glm::inverse(world));
  const bool mirrored = glm::determinant(glm::dmat3(world)) < 0.0;

  PrimitiveInstance placed = what;
  const InstanceId instance(g.primitive_instances.size());
  placed.vertices.first = static_cast<std::uint32_t>(g.positions.size());
  placed.triangles.first = static_cast<std::uint32_t>(g.triangles.size());
  for (std::size_t i = 0; i < p.positions.size(); ++i) {
    g.positions.push_back(transform_point(world, p.positions[i]));
    if (!g.normals.empty()) {
      Vec3& n = g.normals[VertexId(placed.vertices.first + i)];
      if (!p.normals.empty()) n = transform_vector(normal_matrix, p.normals[i]);
      const float length = glm::length(n);
      n = length > 0.f && std::isfinite(length) ? n / length : Vec3(0.f);
    }
    for (std::size_t set = 0; set < 2; ++set)
      if (!p.uvs[set].empty()) g.uvs[set][VertexId(placed.vertices.first + i)] = p.uvs[set][i];
  }
  for (std::array<std::uint32_t, 3> corner : p.triangles) {
    if (mirrored) std::swap(corner[1], corner[2]);
    std::array<VertexId, 3> v;
    for (int k = 0; k < 3; ++k) v[k] = VertexId(placed.vertices.first + corner[k]);
    const Vec3 a = g.positions[v[0]], b = g.positions[v[1]], c = g.positions[v[2]];
    const Vec3 scaled_normal = glm::cross(b - a, c - a);
    if (!usable(a) || !usable(b) || !usable(c) ||
        !(glm::dot(scaled_normal, scaled_normal) >= kLeastSquaredArea)) {
      ++g.degenerate_triangles;
      continue;
    }
    g.triangles.push_back(v);
    g.materials.push_back(p.material);
    g.instances.push_back(instance);
    for (const Vec3& corner_position : {a, b, c}) g.bounds.extend(corner_position);
  }
  // No triangle uses them any more, and positions can be compared everywhere else.
  for (std::size_t i = placed.vertices.first; i < g.positions.size(); ++i)
    if (!usable(g.positions[VertexId(i)])) g.positions[VertexId(i)] = Vec3(0.f);
  placed.vertices.last = static_cast<std::uint32_t>(g.positions.size());
  placed.triangles.last = static_cast<std::uint32_t>(g.triangles.size());
  g.primitive_instances.push_back(placed);
}

std::size_t copies_of(const Node& node) { return std::max<std::size_t>(1, node.instances.size()); }

// For all that the nodes place, so that nothing has to grow.
void make_room(const Scene& scene, Geometry& g) {
  std::size_t vertices = 0, triangles = 0;
  bool normals = false;
  std::array<bool, 2> uvs{};
  for (const Node& node : scene.nodes) {
    if (!node.mesh.valid()) continue;
    for (const Primitive& p : scene.meshes[node.mesh].primitives) {
      vertices += copies_of(node) * p.positions.size();
      triangles += copies_of(node) * p.triangles.size();
      normals |= !p.normals.empty();
      for (std::size_t set = 0; set < 2; ++set) uvs[set] |= !p.uvs[set].empty();
    }
  }
  g.positions.reserve(vertices + 1);  // rays read beyond the last one
  g.triangles.reserve(triangles);
  g.materials.reserve(triangles);
  g.instances.reserve(triangles);
  if (normals) g.normals.resize(vertices, Vec3(0.f));
  for (std::size_t set = 0; set < 2; ++set)
    if (uvs[set]) g.uvs[set].resize(vertices, Vec2(0.f));
}

PunctualLight place(const Light& light, const Mat4& world) {
  PunctualLight placed;
  placed.kind = light.kind;
  placed.position = transform_point(world, Vec3(0.f));
  placed.direction = turned(world, {0.0, 0.0, -1.0});
  placed.intensity = light.intensity;
  placed.range = light.range;
  placed.cos_inner = std::cos(light.inner_cone_angle);
  placed.cos_outer = std::cos(light.outer_cone_angle);
  return placed;
}

bool can_shine(const PunctualLight& light) {
  const bool has_place = light.kind == Light::Kind::directional || usable(light.position);
  const bool has_direction = light.kind == Light::Kind::point || light.direction != Vec3(0.f);
  return has_place && has_direction;
}

PlacedCamera place(const Camera& camera, const Mat4& world) {
  PlacedCamera placed;
  placed.name = camera.name;
  placed.position = transform_point(world, Vec3(0.f));
  placed.forward = turned(world, {0.0, 0.0, -1.0});
  placed.up = turned(world, {0.0, 1.0, 0.0});
  placed.perspective = camera.perspective;
  placed.vertical_fov = camera.vertical_fov;
  placed.aspect = camera.aspect;
  placed.half_height =
      camera.half_height * glm::length(transform_vector(world, Vec3(0.f, 1.f, 0.f)));
  return placed;
}

Vec2 uv_at(const Geometry& g, std::size_t set, const std::array<VertexId, 3>& v, Vec2 b) {
  return (1.f - b.x - b.y) * g.uv(set, v[0]) + b.x * g.uv(set, v[1]) + b.y * g.uv(set, v[2]);
}

int wrapped(int i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == Wrap::mirror ? 2 * size : size;
  i = ((i % period) + period) % period;
  return i < size ? i : period - 1 - i;
}

const std::array<float, 256>& srgb_to_linear() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {
      const float c = static_cast<float>(i) / 255.f;
      t[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    return t;
  }();
  return table;
}

// Bilinear lookup; colour linear, alpha as stored.
Vec4 sample(const Scene& scene, const TextureRef& ref, Vec2 uv) {
  const Texture& t = scene.textures[ref.texture];
  if (t.texels.empty()) return Vec4(1.f);
  const auto& m = ref.uv_transform;
  const Vec2 at(m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]);
  // Far-off coordinates lose all precision anyway: bring them into int range.
  const float limit = 1e6f;
  const float x = std::clamp(at.x, -limit, limit) * static_cast<float>(t.width) - 0.5f;
  const float y = std::clamp(at.y, -limit, limit) * static_cast<float>(t.height) - 0.5f;
  if (!std::isfinite(x) || !std::isfinite(y)) return Vec4(1.f);
  const float x0 = std::floor(x), y0 = std::floor(y);
  const float fx = x - x0, fy = y - y0;
  const auto& linear = srgb_to_linear();
  const auto texel = [&](int dx, int dy) {
    const double column = static_cast<double>(x0) + dx, row = static_cast<double>(y0) + dy;
    const int i = wrapped(static_cast<int>(std::clamp(column, -2e9, 2e9)), t.width, t.wrap_u);
    const int j = wrapped(static_cast<int>(std::clamp(row, -2e9, 2e9)), t.height, t.wrap_v);
    const auto& p = t.texels[static_cast<std::size_t>(j) * t.width + i];
    return Vec4(linear[p[0]], linear[p[1]], linear[p[2]], static_cast<float>(p[3]) / 255.f);
  };
  return (1.f - fy) * ((1.f - fx) * texel(0, 0) + fx * texel(1, 0)) +
         fy * ((1.f - fx) * texel(0, 1) + fx * texel(1, 1));
}

Vec4 sample(const Scene& scene, const Geometry& g, const TextureRef& ref, TriangleId t,
            Vec2 barycentric) {
  if (!ref.valid()) return Vec4(1.f);
  return sample(scene, ref, uv_at(g, ref.uv_set, g.triangles[t], barycentric));
}

}  // namespace

float lift_distance(const Bounds3f& bounds) {
  return 0x1p-17f * (bounds.empty() ? 1.f : bounds.farthest());
}

Geometry flatten(const Scene& scene) {
  Geometry g;
  make_room(scene, g);
  const IdVector<NodeId, Mat4> global = global_transforms(scene);
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const NodeId id(i);
    const Node& node = scene.nodes[id];
    const Mat4 world = scene.to_world * global[id];
    if (node.light.valid()) {
      PunctualLight light = place(scene.lights[node.light], world);
      light.light = node.light;
      if (can_shine(light))
        g.lights.push_back(light);
      else
        ++g.lights_without_place;
    }
    if (node.camera.valid()) {
      g.cameras.push_back(place(scene.cameras[node.camera], world));
      if (g.cameras.back().name.empty()) g.cameras.back().name = node.name;
    }
    if (!node.mesh.valid()) continue;
    for (std::size_t copy = 0; copy < copies_of(node); ++copy) {
      const Mat4 placed = node.instances.empty() ? world : world * node.instances[copy];
      const std::size_t primitives = scene.meshes[node.mesh].primitives.size();
      for (std::size_t p = 0; p < primitives; ++p) {
        PrimitiveInstance what;
        what.node = id;
        what.copy = static_cast<std::uint32_t>(copy);
        what.mesh = node.mesh;
        what.primitive = static_cast<std::uint32_t>(p);
        append_instance(scene, what, placed, g);
      }
    }
  }
  return g;
}

bool can_look(const PlacedCamera& camera) {
  const auto is_unit = [](const Vec3& v) { return std::abs(glm::dot(v, v) - 1.f) < 1e-3f; };
  return usable(camera.position) && is_unit(camera.forward) && is_unit(camera.up) &&
         std::isfinite(camera.aspect) &&
         (camera.perspective ? camera.vertical_fov > 0.f && camera.vertical_fov < kPi
                             : camera.half_height > 0.f && camera.half_height <= kFarthest);
}

Geometry with_lights_of(const Scene& scene, Geometry geometry) {
  for (PunctualLight& light : geometry.lights)
    light.intensity = scene.lights[light.light].intensity;
  return geometry;
}

Rgb reflectance_at(const Scene& scene, const Geometry& g, TriangleId t, Vec2 barycentric) {
  const Material& m = scene.materials[g.materials[t]];
  const Rgb c = m.reflectance * Rgb(sample(scene, g, m.reflectance_texture, t, barycentric));
  return glm::clamp(c, Rgb(0.f), Rgb(1.f));
}

Rgb emission_at(const Scene& scene, const Geometry& g, TriangleId t, Vec2 barycentric) {
  const Material& m = scene.materials[g.materials[t]];
  return m.emission * Rgb(sample(scene, g, m.emission_texture, t, barycentric));
}

float opacity_at(const Scene& scene, const Geometry& g, TriangleId t, Vec2 barycentric) {
  const Material& m = scene.materials[g.materials[t]];
  float alpha = m.alpha;
  if (m.alpha_texture.valid())
    alpha *= sample(scene, g, m.alpha_texture, t, barycentric).a;
  else if (m.alpha_mode != AlphaMode::opaque)
    alpha *= sample(scene, g, m.reflectance_texture, t, barycentric).a;
  if (m.alpha_mode == AlphaMode::opaque) alpha = 1.f;
  if (m.alpha_mode == AlphaMode::mask) alpha = alpha >= m.alpha_cutoff ? 1.f : 0.f;
  return std::clamp(alpha * (1.f - m.transmission), 0.f, 1.f);
}

bool may_be_transparent(const Material& m) {
  return m.transmission > 0.f ||
         (m.alpha_mode != AlphaMode::opaque &&
          (m.alpha < 1.f || m.alpha_texture.valid() || m.reflectance_texture.valid()));
}

}  // namespace halflight
