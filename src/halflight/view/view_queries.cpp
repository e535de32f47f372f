#include "halflight/view/view_queries.h"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "halflight/output/read_light.h"
#include "halflight/view/packet.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr int kMostHidden = 64;  // sides that nobody is shown, one behind the other
constexpr std::size_t kMostLines = 400;
constexpr int kExactRays = 512;

json rgb(const Rgb& c) { return {c.r, c.g, c.b}; }

// The first side that the page shows: others can see no light and are seen through.
std::optional<RayHit> first_shown(const SolverState& state, Vec3 origin, const Vec3& direction) {
  const World& world = *state.world;
  for (int i = 0; i < kMostHidden; ++i) {
    const auto hit = world.rays.first_surface(origin, direction, kInfinity);
    if (!hit) return std::nullopt;
    const bool emits = world.scene.materials[world.geometry.materials[hit->triangle]].emits();
    if (state.tree.side_root(state.surfaces->side_hit(*hit)).valid() || (emits && hit->front))
      return hit;
    origin = world.rays.lift(hit_position(world.geometry, *hit), -hit_normal(world.geometry, *hit));
  }
  return std::nullopt;
}

json element_json(const SolverState& state, ElementId e) {
  std::size_t refined = 0, sampled = 0;
  for (ElementId at = e; at.valid(); at = state.tree[at].parent) {
    refined += state.links.of(at).size();
    sampled += state.sampled_links.of(at).size();
  }
  int depth = 0;
  for (ElementId at = state.tree[e].parent; at.valid(); at = state.tree[at].parent) ++depth;
  return {{"id", e.value},
          {"size", state.tree.cell_size(e)},
          {"area", state.tree[e].area},
          {"depth", depth},
          {"featureSize", state.feature_sizes[e]},
          {"importance", state.importance.empty() ? 1.f : state.importance[e]},
          {"links", state.sampled[e] != 0 ? sampled : refined},
          {"sampled", state.sampled[e] != 0},
          {"irradiance", rgb(state.irradiance[e])},
          {"direct", rgb(state.given_light[e])},
          {"radiosity", rgb(state.radiosity[e])}};
}

struct Arriving {
  ElementId source;
  float irradiance = 0.f;
};

// Strongest first, then by source; at most kMostLines.
std::vector<Arriving> strongest_links(const SolverState& state, ElementId element) {
  std::vector<Arriving> all;
  const bool sampled = state.sampled[element] != 0;
  for (ElementId at = element; at.valid(); at = state.tree[at].parent)
    for (const Link& link : (sampled ? state.sampled_links : state.links).of(at)) {
      if (!link.sampled()) continue;
      const Rgb sent = sampled ? state.radiosity[link.source] - state.exitance[link.source]
                               : state.radiosity[link.source];
      all.push_back({link.source, link.weight * average(sent)});
    }
  std::sort(all.begin(), all.end(), [](const Arriving& a, const Arriving& b) {
    return a.irradiance != b.irradiance ? a.irradiance > b.irradiance : a.source < b.source;
  });
  if (all.size() > kMostLines) all.resize(kMostLines);
  return all;
}

Result<void> check_cell(const SolverState& state, ElementId e) {
  if (e.value >= state.tree.size() || state.tree[e].is_cluster())
    return input_error("there is no such element any more", "live view", "pick it again");
  return {};
}

}  // namespace

Result<ProbeRay> parse_probe_ray(std::string_view text) {
  const json object = parsed_request(text);
  ProbeRay ray;
  const auto vector = [&](const char* name, Vec3& to) {
    if (!object.is_object() || !object.contains(name)) return false;
    const json& j = object[name];
    if (!j.is_array() || j.size() != 3) return false;
    for (int i = 0; i < 3; ++i) {
      const json& component = j[static_cast<std::size_t>(i)];
      if (!component.is_number()) return false;
      to[i] = component.get<float>();
    }
    return is_finite(to);
  };
  if (!vector("origin", ray.origin) || !vector("direction", ray.direction))
    return input_error("a probe needs 'origin' and 'direction', three numbers each", "request");
  const float length = glm::length(ray.direction);
  if (!(length > 0.f) || !std::isfinite(length))
    return input_error("'direction' points nowhere", "request");
  ray.direction /= length;
  ray.exact = object.value("exact", json(false)) == json(true);
  return ray;
}

std::string probe(const LiveSolution& live, const ProbeRay& ray) {
  const SolverState& state = *live.scene.state;
  const World& world = *state.world;
  const auto hit = first_shown(state, ray.origin, ray.direction);
  if (!hit) return json_text({{"hit", false}});
  const Geometry& g = world.geometry;
  const Vec3 x = hit_position(g, *hit), n = hit_normal(g, *hit);
  const PrimitiveInstance& instance = g.primitive_instances[g.instances[hit->triangle]];
  const Material& material = world.scene.materials[g.materials[hit->triangle]];
  json answer{
      {"hit", true},
      {"position", rgb(x)},
      {"normal", rgb(n)},
      {"front", hit->front},
      {"distance", glm::distance(ray.origin, x)},
      {"node", instance.node.value},
      {"nodeName", world.scene.nodes[instance.node].name},
      {"material", material.name},
      {"reflectance", rgb(reflectance_at(world.scene, g, hit->triangle, hit->barycentric))}};
  if (hit->front || material.double_sided)
    answer["emission"] = rgb(emission_at(world.scene, g, hit->triangle, hit->barycentric));
  const ElementId leaf = state.tree.leaf_hit(*hit);
  if (leaf.valid()) answer["element"] = element_json(state, leaf);
  if (ray.exact) {
    ReadOptions options = kMeshReading;
    options.gather_rays = kExactRays;
    const Reading reading = SolutionReader(state, options).read({x, n, hit->triangle});
    answer["irradiance"] = rgb(reading.irradiance());
    answer["direct"] = rgb(reading.direct);
  } else if (leaf.valid()) {
    answer["irradiance"] = rgb(SmoothIrradiance(state).at(leaf, x));
  }
  return json_text(answer);
}

Result<std::string> links_packet(const LiveSolution& live, ElementId element) {
  const SolverState& state = *live.scene.state;
  if (auto ok = check_cell(state, element); !ok) return tl::unexpected(ok.error());
  const std::vector<Arriving> links = strongest_links(state, element);
  std::vector<Vec3> lines;
  std::vector<float> irradiance;
  for (const Arriving& link : links) {
    lines.insert(lines.end(), {state.tree[element].center(), state.tree[link.source].center()});
    irradiance.push_back(link.irradiance);
  }
  Packet packet;
  packet.header["kind"] = "links";
  packet.header["sampled"] = state.sampled[element] != 0;
  packet.add<Vec3>("lines", "f32", lines);
  packet.add<float>("values", "f32", irradiance);
  return packet.bytes();
}

Result<std::string> cut_packet(const LiveSolution& live, ElementId element) {
  const SolverState& state = *live.scene.state;
  if (auto ok = check_cell(state, element); !ok) return tl::unexpected(ok.error());
  const MultiresTree* tree = state.visibility->tree();
  if (!tree)
    return input_error("every ray is traced exactly here", "live view",
                       "choose multires or average visibility to see clusters as media");
  // Towards the brightest emitter, or else the strongest link.
  Vec3 towards = state.world->geometry.bounds.center();
  float brightest = 0.f;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    const float power = state.tree[e].area * average(state.exitance[e]);
    if (state.tree[e].is_cluster() || !(power > brightest)) continue;
    brightest = power;
    towards = state.tree[e].center();
  }
  const Vec3 from =
      state.world->rays.lift(state.tree[element].center(), state.tree.normal(element));
  VisibilityRay ray{from, towards - from, 1.f};
  if (!(glm::length(ray.direction) > 0.f)) ray.direction = Vec3(0.f, 1.f, 0.f);
  const auto parts = tree->cut(ray, StopRule::between(state.feature_sizes[element], 0.f),
                               state.visibility->mode() == VisibilityMode::average);
  std::vector<Vec3> boxes;
  std::vector<float> stopped, extinction;
  for (const MultiresTree::CutPart& part : parts) {
    boxes.insert(boxes.end(), {part.box.lower, part.box.upper});
    stopped.push_back(part.stopped ? 1.f : 0.f);
    extinction.push_back(part.extinction);
  }
  Packet packet;
  packet.header["kind"] = "cut";
  const std::vector<Vec3> line{from, towards};
  packet.add<Vec3>("lines", "f32", line);
  packet.add<Vec3>("boxes", "f32", boxes);
  packet.add<float>("averaged", "f32", stopped);
  packet.add<float>("extinction", "f32", extinction);
  return packet.bytes();
}

}  // namespace halflight
