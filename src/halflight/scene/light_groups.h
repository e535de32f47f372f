// Emitters that are switched together: what dims or recolours them knows them by one name.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct LightGroup {
  std::string name;
  std::vector<MaterialId> materials;
  std::vector<LightId> lights;
  bool sky = false;

  bool empty() const { return materials.empty() && lights.empty() && !sky; }
};

// All emitting materials that something has, punctual lights that stand somewhere, and "sky": a
// group for each name; what has no name is called after its number, as "material 3" or "light 0".
// `together` puts several into one: "ceiling=LampA,LampB;desk=LampC".
Result<std::vector<LightGroup>> find_light_groups(const Scene& scene,
                                                  std::string_view together = {});

// The scene with the light of each group multiplied by a factor.
Scene with_factors(Scene scene, std::span<const LightGroup> groups, std::span<const Rgb> factors);

}  // namespace halflight
