// A bushy plant in a pot: a few stems and many small two-sided leaves, porous to light.
#pragma once

#include <cstdint>

#include "halflight/scene/scene.h"

namespace halflight {

struct PlantMaterials {
  MaterialId pot, soil, stem, young_leaf, old_leaf;
};
PlantMaterials add_plant_materials(Scene& scene);

struct PlantShape {
  int leaves = 1500;        // two triangles each, 1 to 4 cm long
  float pot_height = 0.3f;  // metres
  float height = 1.3f;      // of the whole plant, metres
  float spread = 0.32f;     // radius within which the stems end, metres
};
// Stands at the origin.
MeshId add_plant(Scene& scene, const PlantMaterials& materials, const PlantShape& shape,
                 std::uint64_t seed);

}  // namespace halflight
