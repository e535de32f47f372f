#include "halflight/view/draft_light.h"

#include "halflight/base/parallel.h"
#include "halflight/output/smooth_irradiance.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr float kMiddleGrey = 0.18f;
constexpr double kLeastShown = 0.1;  // of the mean luminance

}  // namespace

DraftLight::DraftLight(const World& world, const ViewMesh& mesh) : mesh_(&mesh) {
  const std::size_t n = mesh.triangles.size();
  restart(world);
  first_of_vertex_.assign(mesh.positions.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++first_of_vertex_[v + 1];
  for (std::size_t v = 1; v < first_of_vertex_.size(); ++v)
    first_of_vertex_[v] += first_of_vertex_[v - 1];
  triangles_of_vertex_.resize(3 * n);
  std::vector<std::uint32_t> next(first_of_vertex_.begin(), first_of_vertex_.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const std::uint32_t v : mesh.triangles[i]) triangles_of_vertex_[next[v]++] = i;
}

void DraftLight::restart(const World& world) {
  const std::size_t n = mesh_->triangles.size();
  middles_.resize(n);
  areas_.resize(n);
  reflectance_.resize(n);
  emits_.resize(n);
  cells_.assign(n, ElementId());
  parallel_for(n, kGrain, [&](std::size_t i) {
    const ViewTriangle& t = mesh_->triangles[i];
    const Vec3 a = mesh_->positions[t[0]], b = mesh_->positions[t[1]], c = mesh_->positions[t[2]];
    middles_[i] = (a + b + c) / 3.f;
    areas_[i] = 0.5f * glm::length(glm::cross(b - a, c - a));
    const Material& m = world.scene.materials[world.geometry.materials[mesh_->sources[i]]];
    reflectance_[i] = luminance(m.reflectance);
    emits_[i] = m.emits() ? 1 : 0;
  });
}

void DraftLight::find_cells(const SolverState& state) {
  parallel_for(cells_.size(), kGrain, [&](std::size_t i) {
    if (cells_[i].valid() && state.tree[cells_[i]].is_leaf()) return;
    const SideId side =
        side_of(state.surfaces->of_triangle[mesh_->sources[i]], mesh_->back[i] != 0);
    cells_[i] = state.tree.find_leaf(side, middles_[i]);
  });
}

DraftLight::Frame DraftLight::read(const SolverState& state) {
  find_cells(state);
  const SmoothIrradiance smooth(state);
  std::vector<Rgb> of_triangles(cells_.size(), Rgb(0.f));
  parallel_for(cells_.size(), kGrain, [&](std::size_t i) {
    if (cells_[i].valid()) of_triangles[i] = smooth.at(cells_[i], middles_[i]);
  });
  Frame frame;
  frame.irradiance.resize(mesh_->positions.size());
  parallel_for(frame.irradiance.size(), kGrain, [&](std::size_t v) {
    Rgb sum(0.f);
    float area = 0.f;
    for (std::uint32_t k = first_of_vertex_[v]; k < first_of_vertex_[v + 1]; ++k) {
      const std::uint32_t t = triangles_of_vertex_[k];
      sum += areas_[t] * of_triangles[t];
      area += areas_[t];
    }
    frame.irradiance[v] = area > 0.f ? sum / area : Rgb(0.f);
  });
  // Log-average luminance (Reinhard et al. 2002) of what is seen of lit surfaces that are no lamps.
  // Hidden corners without light are not what a picture is exposed for.
  double sum = 0.0, logs = 0.0, area = 0.0;
  const auto shown = [&](std::size_t i) {
    return emits_[i] == 0 ? reflectance_[i] * luminance(of_triangles[i]) / kPi : 0.f;
  };
  for (std::size_t i = 0; i < of_triangles.size(); ++i) {
    sum += static_cast<double>(areas_[i] * shown(i));
    area += shown(i) > 0.f ? static_cast<double>(areas_[i]) : 0.0;
  }
  if (!(sum > 0.0)) return frame;
  const auto least = static_cast<float>(kLeastShown * sum / area);
  area = 0.0;
  for (std::size_t i = 0; i < of_triangles.size(); ++i) {
    if (!(shown(i) > least)) continue;
    logs += static_cast<double>(areas_[i] * std::log(shown(i)));
    area += static_cast<double>(areas_[i]);
  }
  frame.exposure = kMiddleGrey / static_cast<float>(std::exp(logs / area));
  return frame;
}

std::vector<float> DraftLight::spread(const SolverState& state,
                                      const IdVector<ElementId, float>& of_cells) {
  find_cells(state);
  std::vector<float> values(mesh_->positions.size(), 0.f);
  parallel_for(values.size(), kGrain, [&](std::size_t v) {
    float sum = 0.f, area = 0.f;
    for (std::uint32_t k = first_of_vertex_[v]; k < first_of_vertex_[v + 1]; ++k) {
      const std::uint32_t t = triangles_of_vertex_[k];
      if (!cells_[t].valid()) continue;
      sum += areas_[t] * of_cells[cells_[t]];
      area += areas_[t];
    }
    if (area > 0.f) values[v] = sum / area;
  });
  return values;
}

}  // namespace halflight
