#include "halflight/view/view_layers.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "halflight/base/parallel.h"
#include "halflight/features/feature_mask.h"
#include "halflight/rays/path_traced_image.h"
#include "halflight/transport/refine.h"
#include "halflight/view/packet.h"
#include "halflight/visibility/blocker_size.h"
#include "halflight/visibility/extinction.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr std::size_t kMostCells = 150'000;
constexpr float kLineLift = 3e-4f;  // of the scene's diagonal: outlines lie before their surfaces
constexpr std::size_t kMostClusters = 3000;
constexpr std::size_t kMostPictured = 20'000;  // triangles, of all clusters whose BSIZE is measured
constexpr int kMaskWidth = 320;
constexpr std::uint32_t kMaskSamples = 16;
constexpr int kBins = 48;           // of the histogram
constexpr float kLowestBin = -4.f;  // decades
constexpr float kDecadesOfBin = 1.f / 6.f;

std::vector<TriangleId> triangles_below(const SolverState& state, ElementId cluster) {
  std::vector<TriangleId> triangles;
  std::vector<ElementId> open{cluster};
  while (!open.empty()) {
    const Element& e = state.tree[open.back()];
    open.pop_back();
    if (e.is_cluster()) {
      for (const ElementId child : e.children()) open.push_back(child);
      continue;
    }
    const Surface& s = (*state.surfaces)[e.side];
    for (std::uint32_t k = 0; k < s.triangle_count; ++k)
      triangles.push_back(state.surfaces->triangles[s.first_triangle + k]);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

// Those at the depth, and leaves that end above it.
std::vector<ElementId> clusters_at(const ElementTree& tree, int depth) {
  std::vector<ElementId> level{tree.root()};
  for (int d = 0; d < depth; ++d) {
    std::vector<ElementId> next;
    for (const ElementId e : level) {
      bool opened = false;
      for (const ElementId child : tree[e].children())
        if (tree[child].is_cluster()) {
          next.push_back(child);
          opened = true;
        }
      if (!opened) next.push_back(e);
    }
    if (next.size() > kMostClusters) break;
    level = std::move(next);
  }
  return level;
}

// Squared errors of all links that bring light to a leaf, over its own irradiance.
IdVector<ElementId, float> errors_by_oracle(const SolverState& state, float mean) {
  const ElementTree& tree = state.tree;
  IdVector<ElementId, float> error(tree.size(), 0.f);
  const float whole = std::max(tree[tree.root()].area, 1e-30f);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId e(i);
    float sum = tree[e].parent.valid() ? error[tree[e].parent] : 0.f;
    const float share = std::sqrt(std::max(tree[e].area, 1e-30f) / whole);
    for (const Link& link : state.links.of(e)) {
      if (!link.sampled()) continue;
      const float of_link =
          weighted_error(tree, state.inside.get(), e, link, state.radiosity) / share;
      sum += of_link * of_link;
    }
    error[e] = sum;
  }
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const ElementId e(i);
    const float light = std::max(mean, average(state.irradiance[e]));
    error[e] = std::min(1.f, std::sqrt(error[e]) / std::max(light, 1e-30f));
  }
  return error;
}

}  // namespace

std::string elements_packet(const LiveSolution& live) {
  const SolverState& state = *live.scene.state;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < state.tree.size(); ++i)
    cells += state.tree[ElementId(i)].is_leaf_cell() ? 1 : 0;
  const std::size_t step = (cells + kMostCells - 1) / kMostCells;
  const float lift = kLineLift * state.world->geometry.bounds.diagonal();
  std::vector<Vec3> lines;
  std::size_t number = 0;
  for (std::size_t i = 0; i < state.tree.size(); ++i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell() || number++ % step != 0) continue;
    const Vec3 above = lift * state.tree.normal(e);
    state.tree.for_each_piece(e, [&](std::span<const Vec3> corners) {
      for (std::size_t k = 0; k < corners.size(); ++k) {
        lines.push_back(corners[k] + above);
        lines.push_back(corners[(k + 1) % corners.size()] + above);
      }
    });
  }
  Packet packet;
  packet.header["kind"] = "elements";
  packet.header["cells"] = cells;
  packet.header["shownOneOf"] = step;
  packet.add<Vec3>("lines", "f32", lines);
  return packet.bytes();
}

std::string clusters_packet(const LiveSolution& live, int depth) {
  const SolverState& state = *live.scene.state;
  const World& world = *state.world;
  const std::vector<ElementId> clusters = clusters_at(state.tree, depth);
  const bool clustered = state.visibility->tree() != nullptr;
  const bool average_mode = state.visibility->mode() == VisibilityMode::average;
  const auto blocking = blocking_areas(world.scene, world.geometry, state.surfaces->bodies);
  std::vector<Vec3> boxes;
  std::vector<float> blocker_sizes, extinctions, averaged;
  std::size_t pictured = 0;
  for (const ElementId e : clusters) {
    const std::vector<TriangleId> triangles = triangles_below(state, e);
    Bounds3f box;
    float area = 0.f;
    for (const TriangleId t : triangles) {
      for (const Vec3& corner : world.geometry.corners(t)) box.extend(corner);
      area += blocking[t];
    }
    if (box.empty()) continue;
    // What is left out is told by the longest side, which is never too small.
    float blocker_size = box.longest_side();
    if (pictured + triangles.size() <= kMostPictured) {
      pictured += triangles.size();
      blocker_size =
          measure_blocker_sizes(world.scene, world.geometry, triangles, thickened(box)).isotropic();
    }
    boxes.insert(boxes.end(), {box.lower, box.upper});
    blocker_sizes.push_back(blocker_size);
    extinctions.push_back(extinction(area, thickened(box)));
    const bool small = box.longest_side() <= state.feature_sizes[e];
    averaged.push_back(clustered && (average_mode || small) ? 1.f : 0.f);
  }
  Packet packet;
  packet.header["kind"] = "clusters";
  packet.header["depth"] = depth;
  packet.add<Vec3>("boxes", "f32", boxes);
  packet.add<float>("blockerSize", "f32", blocker_sizes);
  packet.add<float>("extinction", "f32", extinctions);
  packet.add<float>("averaged", "f32", averaged);
  return packet.bytes();
}

std::string error_packet(const LiveSolution& live) {
  const SolverState& state = *live.scene.state;
  const float mean = std::max(mean_irradiance(state), 1e-30f);
  std::vector<float> errors;
  if (live.sharp) {
    const std::vector<Rgb> exact = vertex_light(*live.sharp);
    const DraftLight::Frame cells = live.draft.read(state);
    errors.resize(exact.size());
    for (std::size_t v = 0; v < errors.size(); ++v)
      errors[v] = std::min(1.f, average(glm::abs(cells.irradiance[v] - exact[v])) /
                                    std::max(mean, average(exact[v])));
  } else {
    errors = live.draft.spread(state, errors_by_oracle(state, mean));
  }
  Packet packet;
  packet.header["kind"] = "error";
  packet.header["epoch"] = live.mesh.epoch;
  packet.header["measured"] = live.sharp != nullptr;
  packet.add<float>("values", "f32", errors);
  return packet.bytes();
}

std::string histogram(const LiveSolution& live) {
  const SolverState& state = *live.scene.state;
  float threshold = state.schedule.irradiance_threshold;
  for (auto r = state.history.rbegin(); !(threshold > 0.f) && r != state.history.rend(); ++r)
    threshold = r->irradiance_threshold;
  std::vector<std::size_t> counts(kBins, 0);
  for (std::size_t i = 0; i < state.tree.size() && threshold > 0.f; ++i) {
    const ElementId e(i);
    for (const Link& link : state.links.of(e)) {
      const float error = weighted_error(state.tree, state.inside.get(), e, link, state.radiosity) /
                          (state.tolerance[e] * threshold);
      if (!(error > 0.f)) continue;
      const float bin = (std::log10(error) - kLowestBin) / kDecadesOfBin;
      ++counts[static_cast<std::size_t>(std::clamp(bin, 0.f, static_cast<float>(kBins - 1)))];
    }
  }
  return json_text({{"counts", counts},
                    {"lowest", kLowestBin},
                    {"step", kDecadesOfBin},
                    {"threshold", threshold},
                    {"level", state.schedule.level},
                    {"levels", state.options.levels}});
}

std::string feature_mask_packet(const LiveSolution& live, const ViewOfInterest& view,
                                float pixels) {
  const World& world = *live.scene.state->world;
  const int height =
      std::clamp(kMaskWidth * view.height / std::max(1, view.width), 1, 2 * kMaskWidth);
  const Image visibility =
      visibility_image(PathTracer(world), CameraRays(view.camera, kMaskWidth, height), kMaskWidth,
                       height, kMaskSamples, 0, Progress());
  std::vector<float> share;
  for (const Rgb& pixel : visibility.pixels) share.push_back(pixel.r);
  const float scale = static_cast<float>(kMaskWidth) / static_cast<float>(std::max(1, view.width));
  const BinaryImage shadow = shadow_of(share, kMaskWidth, height);
  const BinaryImage mask = feature_mask(shadow, static_cast<double>(pixels * scale));
  std::vector<std::uint32_t> classes;  // 0 lit, 1 shadow of smaller features, 2 feature
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < kMaskWidth; ++x)
      classes.push_back(mask.at(x, y) ? 2u : shadow.at(x, y) ? 1u : 0u);
  Packet packet;
  packet.header["kind"] = "features";
  packet.header["width"] = kMaskWidth;
  packet.header["height"] = height;
  packet.header["pixels"] = pixels;
  packet.add<std::uint32_t>("classes", "u32", classes);
  return packet.bytes();
}

}  // namespace halflight
