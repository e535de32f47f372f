#include "halflight/solve/feature_sizes.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace halflight {
namespace {

constexpr float kNone = -1.f;

// A name with stars as bits: the i-th is set while its first i letters stand for what has been
// read, so that any name is read once, whatever the stars could stand for.
class Pattern {
 public:
  // Not longer than kLongestRuleName.
  explicit Pattern(std::string_view text) {
    for (const char c : text)
      if (c == '*')
        waits_.set(length_);
      else
        by_letter_[static_cast<unsigned char>(c)].set(++length_);
  }

  bool matches(std::string_view name) const {
    Lengths read(1);
    for (const char c : name) {
      read = (read << 1 & by_letter_[static_cast<unsigned char>(c)]) | (read & waits_);
      if (read.none()) return false;
    }
    return read[length_];
  }

 private:
  using Lengths = std::bitset<kLongestRuleName + 1>;
  std::array<Lengths, 256> by_letter_{};  // where a letter leads to
  Lengths waits_;                         // where a star takes any letter
  std::size_t length_ = 0;                // without stars
};

// 1 where the name matches; everywhere when there is no pattern.
template <class IdT, class T>
IdVector<IdT, std::uint8_t> named(const IdVector<IdT, T>& items, const std::string& pattern) {
  IdVector<IdT, std::uint8_t> found(items.size(), 1);
  if (pattern.empty()) return found;
  const Pattern letters(pattern);
  for (std::size_t i = 0; i < items.size(); ++i)
    found[IdT(i)] = letters.matches(items[IdT(i)].name) ? 1 : 0;
  return found;
}

// What the rule is about, but for what has no triangles.
std::vector<InstanceId> instances_of(const FeatureSizeRule& rule, const World& world) {
  const Scene& scene = world.scene;
  const auto materials = named(scene.materials, rule.material);
  auto nodes = named(scene.nodes, rule.node);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeId parent = scene.nodes[NodeId(i)].parent;
    if (parent.valid()) nodes[NodeId(i)] |= nodes[parent];
  }
  std::vector<InstanceId> found;
  const auto& placed = world.geometry.primitive_instances;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const PrimitiveInstance& p = placed[InstanceId(i)];
    if (!p.triangles.empty() && nodes[p.node] != 0 &&
        materials[scene.meshes[p.mesh].primitives[p.primitive].material] != 0)
      found.emplace_back(i);
  }
  return found;
}

}  // namespace

Result<void> check_rules(const std::vector<FeatureSizeRule>& rules, const World& world,
                         const std::filesystem::path& file) {
  for (const FeatureSizeRule& rule : rules)
    if (instances_of(rule, world).empty())
      return input_error(fmt::format("no surface has material '{}' and node '{}'",
                                     rule.material.empty() ? "*" : rule.material,
                                     rule.node.empty() ? "*" : rule.node),
                         file.string(), "names may hold *; halflight inspect lists them");
  return {};
}

FeatureSizes::FeatureSizes(const World& world, const Surfaces& surfaces, float otherwise,
                           const std::vector<FeatureSizeRule>& rules,
                           std::optional<PixelFeatureSize> pixels)
    : otherwise_(otherwise), pixels_(std::move(pixels)) {
  if (rules.empty()) return;
  IdVector<InstanceId, float> by_instance(world.geometry.primitive_instances.size(), kNone);
  for (const FeatureSizeRule& rule : rules)
    for (const InstanceId i : instances_of(rule, world)) by_instance[i] = rule.feature_size;
  by_rule_.reserve(surfaces.surfaces.size());
  for (const Surface& surface : surfaces.surfaces)
    by_rule_.push_back(
        by_instance[world.geometry.instances[surfaces.triangles[surface.first_triangle]]]);
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
