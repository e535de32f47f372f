#include "lit_output.h"

#include <chrono>

#include "halflight/io/write_gltf.h"
#include "halflight/output/exposure.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/read_light.h"

namespace halflight::app {

Result<void> write_lit(const std::filesystem::path& path, const SolverState& state, Report& report,
                       const Progress& progress) {
  const World& world = *state.world;
  const SolutionReader reader(state, kMeshReading);
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  options.finest = finest_mesh_edge(state);
  const auto start = std::chrono::steady_clock::now();
  const LitMesh mesh = build_lit_mesh(
      world.scene, world.geometry,
      [&](std::span<const ReadingPoint> points) { return reader(points, progress); }, options,
      progress);
  report.end_phase("lit mesh", start);
  const float exposure = automatic_exposure(world.scene, world.geometry, mesh.primitives);
  auto written = write_lit_glb(path, world.scene, world.geometry, mesh.primitives, exposure);
  report.end_phase("write lit", start);
  report.set_lit_mesh(mesh, exposure);
  return written;
}

}  // namespace halflight::app
