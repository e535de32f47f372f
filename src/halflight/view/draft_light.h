// Light for every vertex at once, without a ray: the cells' own, smoothed over the triangles that
// are shown.
#pragma once

#include <vector>

#include "halflight/view/view_mesh.h"

namespace halflight {

// Reads the cells in which the triangles' middles lie; a vertex takes the mean of its triangles,
// weighted by area. Remembers cells between readings: they only ever get smaller.
class DraftLight {
 public:
  DraftLight(const World& world, const ViewMesh& mesh);

  // For another state, or after vertices have moved: nothing that was read holds any more.
  void restart(const World& world);

  struct Frame {
    std::vector<Rgb> irradiance;  // of vertices
    float exposure = 1.f;         // brings the log-average of shown radiance to middle grey
  };
  // The state must be the same each time, or one that came of it.
  Frame read(const SolverState& state);

  // One value of each triangle's cell at the vertices, smoothed in the same way.
  std::vector<float> spread(const SolverState& state, const IdVector<ElementId, float>& of_cells);

 private:
  void find_cells(const SolverState& state);

  const ViewMesh* mesh_;
  std::vector<Vec3> middles_;  // of triangles
  std::vector<float> areas_;
  std::vector<float> reflectance_;  // luminance, without textures
  std::vector<std::uint8_t> emits_;
  std::vector<ElementId> cells_;
  std::vector<std::uint32_t> first_of_vertex_;  // into triangles_of_vertex_
  std::vector<std::uint32_t> triangles_of_vertex_;
};

}  // namespace halflight
