// What the live view draws: the triangles of a lit mesh as one list of vertices, and the packet
// that carries it to the page once.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "halflight/output/lit_mesh.h"
#include "halflight/solve/solver.h"
#include "halflight/view/view_chunks.h"

namespace halflight {

struct ViewMesh {
  std::uint32_t epoch = 0;  // a new one for each mesh that is sent
  bool sharp = false;       // follows the light; else cut evenly, before there was any
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;  // as the base colour's texture wants them; empty: no texture
  std::vector<ViewTriangle> triangles;  // grouped by `draws`, in the order of `chunks`
  std::vector<TriangleId> sources;      // the scene's triangle each lies in
  std::vector<std::uint8_t> back;       // of each triangle: shows the back side

  struct Draw {
    MaterialId material;
    bool emits = false;
    std::uint32_t first = 0, count = 0;  // triangles
  };
  std::vector<Draw> draws;
  std::vector<ViewChunk> chunks;

  // Fewer triangles over the same vertices, for pictures that have to be quick; none where that
  // would save too little.
  std::vector<ViewTriangle> simple;
  std::vector<ViewChunk> simple_chunks;
};

// Cuts the sides that can see light into triangles whose size suits the feature size, or larger
// ones where that would be too many vertices. Of more triangles than `most_triangles` only the
// largest are taken.
LitMesh cut_evenly(const SolverState& state, std::size_t most_vertices,
                   std::size_t most_triangles = std::numeric_limits<std::size_t>::max());

// Edges of the simpler mesh that is drawn while the eye moves, metres.
float simple_edge(const SolverState& state);

// Sides that light reaches, by the cells of a solution; the front where it reaches neither.
IdVector<TriangleId, ShownSides> sides_worth_showing(const SolverState& state);

ViewMesh make_view_mesh(const World& world, const LitMesh& mesh);
// Moves what belongs to a node or to one below it.
void translate(ViewMesh& mesh, const World& world, NodeId node, const Vec3& offset);
// The light at the vertices of a lit mesh, in the order of its view mesh.
std::vector<Rgb> vertex_light(const LitMesh& mesh);

// Positions, triangles, materials, cameras and what can be moved or dimmed.
std::string topology_packet(const ViewMesh& mesh, const World& world, const PlacedCamera& first,
                            float feature_size);

}  // namespace halflight
