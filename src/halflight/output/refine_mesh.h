// Subdivides the work mesh until the light is linear along its edges.
#pragma once

#include "halflight/output/lit_mesh.h"
#include "halflight/output/work_mesh.h"

namespace halflight {

// By rounds: edges are chosen, the longest edge of every affected triangle joins them (Rivara 1984:
// no slivers), and triangles are replaced by templates. Fills in the counters of `result`. Returns
// the sheets of the simpler mesh, if the options ask for it.
std::vector<Sheet> refine_mesh(WorkMesh& mesh, const IdVector<TriangleId, ShownSides>& shown,
                               const LightReader& read, const LitMeshOptions& options,
                               float mean_irradiance, const Progress& progress, LitMesh& result);

}  // namespace halflight
