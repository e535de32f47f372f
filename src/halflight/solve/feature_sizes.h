// Feature sizes that differ from place to place: by rules for materials and nodes, or by pixels of
// a view (the paper's plan, section 6: different feature sizes of interest for different surfaces).
#pragma once

#include <optional>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/hierarchy/elements.h"
#include "halflight/io/feature_size_rules.h"
#include "halflight/rays/world.h"

namespace halflight {

// A picture that somebody will look at.
struct ViewOfInterest {
  PlacedCamera camera;
  int width = 0, height = 0;  // pixels
};

struct PixelFeatureSize {
  ViewOfInterest view;
  float pixels = 0.f;  // s is that many pixels at the distance of the surface
};

// Every rule must match something, else the error names it.
Result<void> check_rules(const std::vector<FeatureSizeRule>& rules, const World& world,
                         const std::filesystem::path& file);

// s of any element, the smallest that the last matching rule, or else the view, or else the default
// gives anywhere in it.
class FeatureSizes {
 public:
  FeatureSizes(const World& world, const Surfaces& surfaces, float otherwise,
               const std::vector<FeatureSizeRule>& rules, std::optional<PixelFeatureSize> pixels);

  float of_cell(const Element& cell) const;
  // Of all elements of a tree that has not been split yet.
  IdVector<ElementId, float> of_elements(const ElementTree& tree) const;

 private:
  float at_distance(const Bounds3f& box) const;

  float otherwise_;
  IdVector<SurfaceId, float> by_rule_;  // negative: none; empty: no rules
  std::optional<PixelFeatureSize> pixels_;
};

}  // namespace halflight
