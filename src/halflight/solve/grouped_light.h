// The light of a solve taken apart by who sends it. Radiosity is linear: any mix of dimmed or
// recoloured groups is the sum of their lights.
#pragma once

#include <memory>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/rays/world.h"
#include "halflight/scene/light_groups.h"

namespace halflight {

// What one group gives, shining as the scene says.
struct GroupLight {
  IdVector<ElementId, Rgb> given_light;
  IdVector<ElementId, Rgb> irradiance;
};

struct GroupedLight {
  std::shared_ptr<const World> world{};  // in which all shine as the scene says
  std::vector<LightGroup> groups{};
  std::vector<Rgb> factors{};  // by which the groups are multiplied in the state as it is
  // Of cells, as the scene says; and the light of each group. Empty: not taken apart yet.
  IdVector<ElementId, Rgb> exitance{};
  std::vector<GroupLight> light{};

  bool separated() const { return !light.empty(); }
};

}  // namespace halflight
