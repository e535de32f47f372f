// The output mesh: fine where the light is not linear, coarse elsewhere, without cracks.
// It follows the light alone, not the solver's elements: whatever answers a LightReader can be
// shown.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/io/write_gltf.h"
#include "halflight/output/light_reader.h"
#include "halflight/output/shown_sides.h"

namespace halflight {

struct LitMeshOptions {
  float feature_size = 0.05f;  // s, metres
  float coarse = 0.f;          // no lit edge stays longer, metres; 0: 4 s
  float finest = 0.f;          // edges up to this length are never split, metres; 0: s / 2
  // An edge is split when the light at its middle differs from the mean of its ends by more than
  // this share of the light there (or of 10 % of the mean irradiance, where that is more).
  float tolerance = 0.05f;
  std::size_t max_vertices = 2'000'000;  // the input's own vertices are always kept
  // Edge length, metres: a simpler mesh whose edges are no longer than needed for this is given as
  // well, see LitMesh::simple. 0: none.
  float simple = 0.f;
};

struct LitMesh {
  std::vector<LitPrimitive> primitives;
  // Of each primitive, if asked for: triangles over the same vertices that cover the same surface,
  // as they were when their edges first were short enough, before the light had them split.
  std::vector<std::vector<std::array<std::uint32_t, 3>>> simple;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t readings = 0;        // places where the light was asked for
  std::size_t rounds = 0;          // of subdivision
  Rgb mean_irradiance{0.f};        // over the shown area
  bool limited = false;            // max_vertices (or cancelling) ended the subdivision
  float largest_error_left = 0.f;  // of edges that could not be split, same measure as `tolerance`
};

// Deterministic. `read` is called with large batches, from one thread. Cancelling ends subdivision.
LitMesh build_lit_mesh(const Scene& scene, const Geometry& geometry, const LightReader& read,
                       const LitMeshOptions& options, const Progress& progress = {});

// The same where it is known which sides are to be shown.
LitMesh build_lit_mesh(const Scene& scene, const Geometry& geometry,
                       const IdVector<TriangleId, ShownSides>& shown, const LightReader& read,
                       const LitMeshOptions& options, const Progress& progress = {});

}  // namespace halflight
