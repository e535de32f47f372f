#include "halflight/visibility/coverage_extinction.h"

#include <array>

#include "halflight/base/parallel.h"
#include "halflight/visibility/chords.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/wide_ray.h"

namespace halflight {
namespace {

constexpr int kChords = 64;

// Exact, through all triangles below a node.
float through_node(const Scene& scene, const Geometry& geometry, const MultiresNodes& arrays,
                   std::uint32_t root, const WideRay& ray, float reach) {
  std::array<std::uint32_t, kTraversalStack> stack;
  std::size_t stacked = 0;
  stack[stacked++] = root;
  float light = 1.f;
  while (stacked > 0) {
    const MultiresNode& node = arrays.nodes[stack[--stacked]];
    const unsigned met = meet_slots(node, ray, reach, reach).met;
    for (unsigned blocks = met >> node.node_count; blocks != 0; blocks &= blocks - 1) {
      const auto i = static_cast<unsigned>(__builtin_ctz(blocks));
      light *= through_block(scene, geometry, arrays.blocks[node.first_block + i], ray, reach);
      if (light < kBlockedBelow) return 0.f;
    }
    for_each_bit(met & ((1u << node.node_count) - 1u),
                 [&](unsigned slot) { stack[stacked++] = node.first_node + slot; });
  }
  return light;
}

}  // namespace

void fit_coverage(const Scene& scene, const Geometry& geometry, MultiresNodes& arrays) {
  std::vector<float> extinctions(arrays.contents.size(), 0.f);
  parallel_for(extinctions.size(), 64, [&](std::size_t slot) {
    if (!arrays.has(slot)) return;
    const MultiresNode& node = arrays.nodes[slot / kWide];
    const auto i = static_cast<std::uint32_t>(slot % kWide);
    const Bounds3f box = arrays.box_of(slot);
    std::array<float, kChords> lengths;
    float light = 0.f;
    for (std::uint32_t k = 0; k < kChords; ++k) {
      const VisibilityRay chord = random_chord(box, slot, k);
      const WideRay ray(chord);
      lengths[k] = chord.reach;
      light += i < node.node_count
                   ? through_node(scene, geometry, arrays, node.first_node + i, ray, chord.reach)
                   : through_block(scene, geometry,
                                   arrays.blocks[node.first_block + i - node.node_count], ray,
                                   chord.reach);
    }
    extinctions[slot] = fit_extinction(lengths, light / kChords);
  });
  arrays.store_extinctions(extinctions);
}

}  // namespace halflight
