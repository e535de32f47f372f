#include "halflight/view/view_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "halflight/base/morton_order.h"
#include "halflight/base/parallel.h"
#include "halflight/view/packet.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr float kEdgePerFeature = 2.f;  // length of edges in feature sizes
constexpr float kSimpleEdgePerFeature = 8.f;
constexpr float kSimplerIsWorthIt = 0.7f;  // of the triangles
constexpr std::size_t kMostNodes = 20'000;
// Of the mean irradiance: backs that light only reaches through a gap are not worth vertices.
constexpr float kUnlit = 5e-3f;

json rgb(const Rgb& c) { return {c.r, c.g, c.b}; }

IdVector<TriangleId, ShownSides> live_sides_of(const SolverState& state) {
  const Scene& scene = state.world->scene;
  const Geometry& g = state.world->geometry;
  IdVector<TriangleId, ShownSides> shown(g.triangles.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const TriangleId t(i);
    const SurfaceId s = state.surfaces->of_triangle[t];
    const bool emits = scene.materials[g.materials[t]].emits();
    shown[t].front = emits || state.tree.side_root(side_of(s, false)).valid();
    shown[t].back = state.tree.side_root(side_of(s, true)).valid();
  }
  return shown;
}

void keep_largest(IdVector<TriangleId, ShownSides>& shown, const Geometry& g, std::size_t most) {
  std::vector<std::uint32_t> order(g.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<float> areas(order.size());
  parallel_for(areas.size(), 4096, [&](std::size_t i) { areas[i] = g.area(TriangleId(i)); });
  const auto rest = order.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(order.begin(), rest, order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return areas[a] > areas[b]; });
  for (auto i = rest; i != order.end(); ++i) shown[TriangleId(*i)] = {false, false};
}

// Mean irradiance of every side's cells, brightest channel.
IdVector<SideId, float> light_of_sides(const SolverState& state) {
  IdVector<SideId, float> light(2 * state.surfaces->surfaces.size(), 0.f);
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const Element& e = state.tree[ElementId(i)];
    if (e.is_leaf_cell()) light[e.side] += e.area * max_component(state.irradiance[ElementId(i)]);
  }
  for (std::size_t i = 0; i < light.size(); ++i)
    light[SideId(i)] /= std::max((*state.surfaces)[SideId(i)].area, 1e-30f);
  return light;
}

const TextureRef& shown_texture(const Material& m) {
  return m.reflectance_texture.valid() ? m.reflectance_texture : m.emission_texture;
}

Vec2 transformed(const TextureRef& t, Vec2 uv) {
  const auto& m = t.uv_transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

json texture_json(const Scene& scene, const TextureRef& t) {
  if (!t.valid()) return nullptr;
  const auto name = [](Wrap w) {
    return w == Wrap::repeat ? "repeat" : w == Wrap::mirror ? "mirror" : "clamp";
  };
  const Texture& texture = scene.textures[t.texture];
  return {
      {"id", t.texture.value}, {"wrapU", name(texture.wrap_u)}, {"wrapV", name(texture.wrap_v)}};
}

json material_json(const Scene& scene, const Material& m) {
  const auto mode = m.alpha_mode == AlphaMode::mask    ? "mask"
                    : m.alpha_mode == AlphaMode::blend ? "blend"
                                                       : "opaque";
  return {{"name", m.name},
          {"reflectance", rgb(m.reflectance)},
          {"texture", texture_json(scene, m.reflectance_texture)},
          {"emission", rgb(m.emission)},
          {"emissionTexture", texture_json(scene, m.emission_texture)},
          {"alphaMode", mode},
          {"alpha", m.alpha * (1.f - m.transmission)},
          {"alphaCutoff", m.alpha_cutoff}};
}

json camera_json(const PlacedCamera& c) {
  return {{"name", c.name},
          {"position", rgb(c.position)},
          {"forward", rgb(c.forward)},
          {"up", rgb(c.up)},
          {"perspective", c.perspective},
          {"fov", c.vertical_fov},
          {"halfHeight", c.half_height}};
}

bool is_simple_worth_it(const LitMesh& lit) {
  std::size_t simple = 0;
  for (const auto& triangles : lit.simple) simple += triangles.size();
  return simple > 0 &&
         static_cast<float>(simple) < kSimplerIsWorthIt * static_cast<float>(lit.triangles);
}

// Nodes that place something: what can be moved and switched.
json nodes_json(const World& world) {
  IdVector<NodeId, Bounds3f> boxes(world.scene.nodes.size());
  const Geometry& g = world.geometry;
  for (const PrimitiveInstance& p : g.primitive_instances)
    for (const VertexId v : p.vertices) boxes[p.node].extend(g.positions[v]);
  json nodes = json::array();
  for (std::size_t i = 0; i < boxes.size() && nodes.size() < kMostNodes; ++i) {
    const Node& node = world.scene.nodes[NodeId(i)];
    const Bounds3f& box = boxes[NodeId(i)];
    if (box.empty() && !node.light.valid()) continue;
    json item{{"id", i}, {"name", node.name}, {"light", node.light.valid()}};
    if (!box.empty()) item["box"] = {rgb(box.lower), rgb(box.upper)};
    nodes.push_back(std::move(item));
  }
  return nodes;
}

}  // namespace

IdVector<TriangleId, ShownSides> sides_worth_showing(const SolverState& state) {
  const Scene& scene = state.world->scene;
  const Geometry& g = state.world->geometry;
  const IdVector<SideId, float> light = light_of_sides(state);
  const float unlit = kUnlit * mean_irradiance(state);
  IdVector<TriangleId, ShownSides> shown(g.triangles.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const TriangleId t(i);
    const SurfaceId s = state.surfaces->of_triangle[t];
    const Material& m = scene.materials[g.materials[t]];
    shown[t].back = light[side_of(s, true)] > unlit || (m.emits() && m.double_sided);
    shown[t].front = light[side_of(s, false)] > unlit || m.emits() || !shown[t].back;
  }
  return shown;
}

float simple_edge(const SolverState& state) {
  return kSimpleEdgePerFeature * state.options.feature_size;
}

LitMesh cut_evenly(const SolverState& state, std::size_t most_vertices,
                   std::size_t most_triangles) {
  const Geometry& g = state.world->geometry;
  auto shown = live_sides_of(state);
  if (g.triangles.size() > most_triangles) keep_largest(shown, g, most_triangles);
  double area = 0.0;
  for (std::size_t i = 0; i < shown.size(); ++i)
    area += static_cast<double>(g.area(TriangleId(i))) *
            ((shown[TriangleId(i)].front ? 1 : 0) + (shown[TriangleId(i)].back ? 1 : 0));
  // Triangles of edge l have about area / l^2 vertices.
  const auto fewest =
      static_cast<float>(std::sqrt(area / std::max(1.0, 0.5 * static_cast<double>(most_vertices))));
  LitMeshOptions options;
  options.feature_size = std::max(state.options.feature_size, 1e-4f * g.bounds.diagonal());
  options.coarse = std::max(kEdgePerFeature * options.feature_size, fewest);
  options.finest = options.coarse;
  options.max_vertices = 2 * most_vertices;
  options.simple = simple_edge(state);
  const LightReader evenly = [](std::span<const ReadingPoint> points) {
    return std::vector<Reading>(points.size(), Reading{Rgb(1.f), Rgb(0.f)});
  };
  return build_lit_mesh(state.world->scene, g, shown, evenly, options);
}

void translate(ViewMesh& mesh, const World& world, NodeId node, const Vec3& offset) {
  const Geometry& g = world.geometry;
  IdVector<InstanceId, std::uint8_t> moves(g.primitive_instances.size(), 0);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    NodeId at = g.primitive_instances[InstanceId(i)].node;
    while (at.valid() && at != node) at = world.scene.nodes[at].parent;
    moves[InstanceId(i)] = at.valid() ? 1 : 0;
  }
  std::vector<std::uint8_t> moved(mesh.positions.size(), 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (moves[g.instances[mesh.sources[i]]] != 0)
      for (const std::uint32_t v : mesh.triangles[i]) moved[v] = 1;
  for (std::size_t v = 0; v < moved.size(); ++v)
    if (moved[v] != 0) mesh.positions[v] += offset;
  refit(mesh.chunks, mesh.positions, mesh.triangles);
  refit(mesh.simple_chunks, mesh.positions, mesh.simple);
}

ViewMesh make_view_mesh(const World& world, const LitMesh& lit) {
  const Scene& scene = world.scene;
  const Geometry& g = world.geometry;
  ViewMesh mesh;
  struct Part {
    MaterialId material;
    bool emits;
    std::uint32_t primitive, first_vertex;
  };
  std::vector<Part> parts;
  bool textured = false;
  mesh.positions.reserve(lit.vertices);
  for (std::size_t i = 0; i < lit.primitives.size(); ++i) {
    const LitPrimitive& p = lit.primitives[i];
    const PrimitiveInstance& what = g.primitive_instances[p.instance];
    const MaterialId id = scene.meshes[what.mesh].primitives[what.primitive].material;
    const Material& m = scene.materials[id];
    parts.push_back({id, m.emits() && (!p.back || m.double_sided), static_cast<std::uint32_t>(i),
                     static_cast<std::uint32_t>(mesh.positions.size())});
    mesh.positions.insert(mesh.positions.end(), p.positions.begin(), p.positions.end());
    textured |= shown_texture(m).valid();
  }
  if (textured) {
    mesh.uvs.assign(mesh.positions.size(), Vec2(0.f));
    for (const Part& part : parts) {
      const TextureRef& texture = shown_texture(scene.materials[part.material]);
      if (!texture.valid()) continue;
      const auto set = static_cast<std::size_t>(std::clamp(texture.uv_set, 0, 1));
      const std::vector<Vec2>& uvs = lit.primitives[part.primitive].uvs[set];
      for (std::size_t k = 0; k < uvs.size(); ++k)
        mesh.uvs[part.first_vertex + k] = transformed(texture, uvs[k]);
    }
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::pair(a.material, a.emits) < std::pair(b.material, b.emits);
  });
  const bool with_simple = is_simple_worth_it(lit);
  std::vector<std::uint32_t> simple_sizes;  // of draws
  for (const Part& part : parts) {
    const LitPrimitive& p = lit.primitives[part.primitive];
    const auto first = static_cast<std::uint32_t>(mesh.triangles.size());
    if (mesh.draws.empty() || mesh.draws.back().material != part.material ||
        mesh.draws.back().emits != part.emits)
      mesh.draws.push_back({part.material, part.emits, first, 0});
    for (std::size_t k = 0; k < p.triangles.size(); ++k) {
      const auto& t = p.triangles[k];
      mesh.triangles.push_back(
          {part.first_vertex + t[0], part.first_vertex + t[1], part.first_vertex + t[2]});
      mesh.sources.push_back(p.sources[k]);
      mesh.back.push_back(p.back ? 1 : 0);
    }
    mesh.draws.back().count += static_cast<std::uint32_t>(p.triangles.size());
    simple_sizes.resize(mesh.draws.size(), 0);
    if (!with_simple) continue;
    for (const ViewTriangle& t : lit.simple[part.primitive])
      mesh.simple.push_back(
          {part.first_vertex + t[0], part.first_vertex + t[1], part.first_vertex + t[2]});
    simple_sizes.back() += static_cast<std::uint32_t>(lit.simple[part.primitive].size());
  }
  std::vector<std::uint32_t> sizes;
  for (const ViewMesh::Draw& d : mesh.draws) sizes.push_back(d.count);
  auto [order, chunks] = arrange_in_chunks(mesh.positions, mesh.triangles, sizes);
  mesh.chunks = std::move(chunks);
  arrange(mesh.triangles, order);
  arrange(mesh.sources, order);
  arrange(mesh.back, order);
  if (with_simple) {
    auto [simple_order, simple_chunks] =
        arrange_in_chunks(mesh.positions, mesh.simple, simple_sizes);
    mesh.simple_chunks = std::move(simple_chunks);
    arrange(mesh.simple, simple_order);
  }
  return mesh;
}

std::vector<Rgb> vertex_light(const LitMesh& mesh) {
  std::vector<Rgb> light;
  light.reserve(mesh.vertices);
  for (const LitPrimitive& p : mesh.primitives)
    light.insert(light.end(), p.irradiance.begin(), p.irradiance.end());
  return light;
}

std::string topology_packet(const ViewMesh& mesh, const World& world, const PlacedCamera& first,
                            float feature_size) {
  const Scene& scene = world.scene;
  Packet packet;
  json& h = packet.header;
  h["epoch"] = mesh.epoch;
  h["sharp"] = mesh.sharp;
  h["vertices"] = mesh.positions.size();
  h["triangles"] = mesh.triangles.size();
  h["sceneTriangles"] = world.geometry.triangles.size();
  h["featureSize"] = feature_size;
  const Bounds3f& bounds = world.geometry.bounds;
  h["bounds"] = {rgb(bounds.empty() ? Vec3(0.f) : bounds.lower),
                 rgb(bounds.empty() ? Vec3(0.f) : bounds.upper)};
  h["sky"] = rgb(scene.sky);
  h["draws"] = json::array();
  for (const ViewMesh::Draw& d : mesh.draws)
    h["draws"].push_back({{"material", d.material.value},
                          {"emits", d.emits},
                          {"first", d.first},
                          {"count", d.count}});
  h["materials"] = json::array();
  for (const Material& m : scene.materials) h["materials"].push_back(material_json(scene, m));
  h["nodes"] = nodes_json(world);
  h["cameras"] = json::array();
  for (const PlacedCamera& c : world.geometry.cameras)
    if (can_look(c)) h["cameras"].push_back(camera_json(c));
  h["firstView"] = camera_json(first);
  packet.add<Vec3>("positions", "f32", mesh.positions);
  packet.add<ViewTriangle>("indices", "u32", mesh.triangles);
  packet.add<ViewChunk>("chunks", "u32", mesh.chunks);
  if (!mesh.simple.empty()) {
    packet.add<ViewTriangle>("simpleIndices", "u32", mesh.simple);
    packet.add<ViewChunk>("simpleChunks", "u32", mesh.simple_chunks);
  }
  if (!mesh.uvs.empty()) packet.add<Vec2>("uvs", "f32", mesh.uvs);
  return packet.bytes();
}

}  // namespace halflight
