// The JSON report of a solve.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "halflight/output/bake_lightmap.h"
#include "halflight/output/estimated_error.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/solve/solver.h"

namespace halflight {

class Report {
 public:
  using Clock = std::chrono::steady_clock;

  Report() : start_(Clock::now()) {}
  // Records the seconds since `start` under a name; a name given twice adds up.
  void end_phase(const std::string& name, Clock::time_point start);
  void set_lit_mesh(const LitMesh& mesh, float exposure);
  void set_lightmap(const Lightmap& map);
  void set_memory_limit(std::size_t bytes) { memory_limit_ = bytes; }
  void set_estimated_error(const EstimatedError& error) { error_ = error; }

  std::string json(const SolverState& state) const;

 private:
  Clock::time_point start_;
  std::vector<std::pair<std::string, double>> phases_;
  std::vector<std::pair<std::string, std::size_t>> peaks_;  // resident, bytes
  std::size_t memory_limit_ = 0;
  bool has_mesh_ = false;
  std::size_t mesh_vertices_ = 0, mesh_triangles_ = 0, mesh_readings_ = 0;
  float exposure_ = 0.f;
  std::optional<EstimatedError> error_;
  struct LightmapNumbers {
    int size = 0;
    std::size_t charts = 0, read = 0, covered = 0;
    float texels_per_metre = 0.f, filled = 0.f;
    float seams_as_read = 0.f, seams = 0.f;
  };
  std::optional<LightmapNumbers> lightmap_;
};

}  // namespace halflight
