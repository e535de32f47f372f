#include "halflight/solve/memory.h"

#include <algorithm>
#include <limits>

#include "halflight/base/memory.h"

namespace halflight {
namespace {

constexpr std::size_t kProgram = 24u << 20;  // with libraries, threads and buffers
constexpr std::size_t kRaysPerTriangle = 170;
constexpr std::size_t kHierarchyPerTriangle = 40, kHierarchyPerSurface = 640;
constexpr std::size_t kElement = 360;  // a cell made by splitting, with its outline and its light
constexpr std::size_t kSweptElement = 104;  // of every element, while light is swept and read
// A refined link while its list is taken apart and put together again.
constexpr std::size_t kRefinedLink = 76;
constexpr std::size_t kStoredLink = 16;
constexpr std::size_t kSampledLink = 18;       // with what sweeps note of it
constexpr std::size_t kLaterSampledLink = 46;  // where those of an earlier round are taken out
constexpr std::size_t kPortion = 16u << 20;    // receivers that get their links together
constexpr std::size_t kLitVertex = 620;
constexpr double kShareOfElements = 0.5;  // of what is left for elements and links
constexpr std::size_t kNoEnd = std::numeric_limits<std::size_t>::max();

std::size_t bytes_left(const SolverState& state, std::size_t besides) {
  const std::size_t used = counted_bytes(state) + besides;
  return state.options.memory > used ? state.options.memory - used : 0;
}

std::size_t cells_made(const SolverState& state) {
  return state.tree.size() - state.tree.initial_size();
}

}  // namespace

std::size_t bytes_of_world(const World& world) {
  std::size_t bytes = kProgram;
  for (const Mesh& mesh : world.scene.meshes)
    for (const Primitive& p : mesh.primitives)
      bytes += p.positions.size() * sizeof(Vec3) + p.normals.size() * sizeof(Vec3) +
               (p.uvs[0].size() + p.uvs[1].size()) * sizeof(Vec2) +
               p.triangles.size() * sizeof(p.triangles[0]);
  for (const Texture& t : world.scene.textures)
    bytes += t.texels.size() * sizeof(t.texels[0]) + t.encoded.size();
  const Geometry& g = world.geometry;
  bytes += g.positions.size() * (2 * sizeof(Vec3) + 2 * sizeof(Vec2));
  bytes += g.triangles.size() * (3 * sizeof(VertexId) + sizeof(MaterialId) + sizeof(InstanceId));
  return bytes + g.triangles.size() * kRaysPerTriangle;
}

std::size_t bytes_of_hierarchy(std::size_t triangles, std::size_t surfaces) {
  return triangles * kHierarchyPerTriangle + surfaces * kHierarchyPerSurface;
}

std::size_t bytes_of_lit_mesh(std::size_t vertices) { return vertices * kLitVertex; }

std::size_t most_vertices_of_input(const World& world) {
  return 2 * world.geometry.positions.size();
}

std::size_t counted_bytes(const SolverState& state) {
  return bytes_of_world(*state.world) +
         bytes_of_hierarchy(state.world->geometry.triangles.size(),
                            state.surfaces->surfaces.size()) +
         cells_made(state) * kElement + state.tree.size() * kSweptElement +
         (state.links.stored() + state.sampled_links.stored()) * kStoredLink;
}

MemoryRoom memory_room(const SolverState& state) {
  if (state.options.memory == 0) return {kNoEnd, kNoEnd, kNoEnd};
  const std::size_t base = counted_bytes(state) - cells_made(state) * kElement -
                           (state.links.stored() + state.sampled_links.stored()) * kStoredLink;
  const std::size_t left = state.options.memory > base ? state.options.memory - base : 0;
  const auto for_elements = static_cast<std::size_t>(kShareOfElements * static_cast<double>(left));
  const std::size_t for_links = left - std::min(left, cells_made(state) * kElement);
  const std::size_t each = state.schedule.round > 1 ? kLaterSampledLink : kSampledLink;
  return {.elements = state.tree.initial_size() + for_elements / kElement,
          .refined_links = for_links / kRefinedLink,
          .sampled_links = bytes_left(state, kPortion) / each};
}

void drop_links(SolverState& state) {
  state.links = {};
  state.sampled_links = {};
  return_free_memory();
}

}  // namespace halflight
