#include "halflight/solve/feature_sizes.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace halflight {
namespace {

constexpr float kNone = -1.f;

// Where it goes wrong, the last star covers one more character: no earlier one has to change.
bool matches(std::string_view name, std::string_view pattern) {
  constexpr std::size_t kNoStar = std::string_view::npos;
  std::size_t n = 0, p = 0, star = kNoStar, covered = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      covered = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++n;
      ++p;
    } else if (star != kNoStar) {
      p = star + 1;
      n = ++covered;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool node_matches(const Scene& scene, NodeId node, std::string_view pattern) {
  for (; node.valid(); node = scene.nodes[node].parent)
    if (matches(scene.nodes[node].name, pattern)) return true;
  return false;
}

bool applies(const FeatureSizeRule& rule, const World& world, TriangleId t) {
  const Geometry& g = world.geometry;
  if (!rule.material.empty() &&
      !(g.materials[t].valid() &&
        matches(world.scene.materials[g.materials[t]].name, rule.material)))
    return false;
  return rule.node.empty() ||
         node_matches(world.scene, g.primitive_instances[g.instances[t]].node, rule.node);
}

}  // namespace

Result<void> check_rules(const std::vector<FeatureSizeRule>& rules, const World& world,
                         const std::filesystem::path& file) {
  for (const FeatureSizeRule& rule : rules) {
    bool any = false;
    for (std::size_t i = 0; i < world.geometry.triangles.size() && !any; ++i)
      any = applies(rule, world, TriangleId(i));
    if (!any)
      return input_error(fmt::format("no surface has material '{}' and node '{}'",
                                     rule.material.empty() ? "*" : rule.material,
                                     rule.node.empty() ? "*" : rule.node),
                         file.string(), "names may hold *; halflight inspect lists them");
  }
  return {};
}

FeatureSizes::FeatureSizes(const World& world, const Surfaces& surfaces, float otherwise,
                           const std::vector<FeatureSizeRule>& rules,
                           std::optional<PixelFeatureSize> pixels)
    : otherwise_(otherwise), pixels_(std::move(pixels)) {
  if (rules.empty()) return;
  by_rule_ = IdVector<SurfaceId, float>(surfaces.surfaces.size(), kNone);
  for (std::size_t i = 0; i < by_rule_.size(); ++i)
    for (const FeatureSizeRule& rule : rules)
      if (applies(rule, world, surfaces.triangles[surfaces[SurfaceId(i)].first_triangle]))
        by_rule_[SurfaceId(i)] = rule.feature_size;
}

float FeatureSizes::at_distance(const Bounds3f& box) const {
  const PlacedCamera& camera = pixels_->view.camera;
  const auto height = static_cast<float>(std::max(1, pixels_->view.height));
  if (!camera.perspective) return pixels_->pixels * 2.f * camera.half_height / height;
  const Vec3 nearest = glm::clamp(camera.position, box.lower, box.upper);
  const float pixel = 2.f * std::tan(0.5f * camera.vertical_fov) / height;  // at distance 1
  return pixels_->pixels * pixel * glm::length(nearest - camera.position);
}

float FeatureSizes::of_cell(const Element& cell) const {
  if (!by_rule_.empty()) {
    const float s = by_rule_[surface_of(cell.side)];
    if (s != kNone) return s;
  }
  return pixels_ ? at_distance(cell.box) : otherwise_;
}

IdVector<ElementId, float> FeatureSizes::of_elements(const ElementTree& tree) const {
  IdVector<ElementId, float> sizes(tree.size(), otherwise_);
  for (std::size_t i = tree.size(); i-- > 0;) {
    const ElementId e(i);
    if (!tree[e].is_cluster()) {
      sizes[e] = of_cell(tree[e]);
      continue;
    }
    float smallest = kInfinity;
    for (const ElementId child : tree[e].children()) smallest = std::min(smallest, sizes[child]);
    if (!tree[e].is_leaf()) sizes[e] = smallest;
  }
  return sizes;
}

}  // namespace halflight
