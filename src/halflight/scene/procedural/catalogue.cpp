#include "halflight/scene/procedural/catalogue.h"

#include <memory>

#include "halflight/scene/procedural/books.h"
#include "halflight/scene/procedural/cornell_box.h"
#include "halflight/scene/procedural/cube_groups.h"
#include "halflight/scene/procedural/doorway.h"
#include "halflight/scene/procedural/furnace.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"

namespace halflight {
namespace {

template <class Parameters>
Recipe recipe(std::string name, std::string summary, Scene (*build)(const Parameters&)) {
  const auto parameters = std::make_shared<Parameters>();
  return {std::move(name), std::move(summary), knobs(*parameters),
          [=] { return build(*parameters); }};
}

}  // namespace

std::vector<Recipe> scene_recipes() {
  return {
      recipe("furnace", "closed box of equal light everywhere: B = pi L / (1 - rho)",
             furnace_scene),
      recipe("cornell-box", "the measured Cornell box", cornell_box_scene),
      recipe("doorway", "two empty rooms joined by a doorway, a light in one", doorway_scene),
      recipe("cube-groups", "four groups of cubes between a small light and a wall",
             cube_groups_scene),
      recipe("loose-triangles", "random two-sided triangles in a room", loose_triangles_scene),
      recipe("books", "a shelf of books lit by one light", books_scene),
      recipe("plants", "a room full of potted plants and books: porous clutter", plants_scene),
      recipe("office", "desks, shelves of books and many small things", office_scene),
  };
}

Result<Recipe> find_recipe(std::string_view name) {
  std::string known;
  for (Recipe& candidate : scene_recipes()) {
    if (candidate.name == name) return std::move(candidate);
    known += (known.empty() ? "" : ", ") + candidate.name;
  }
  if (name.empty()) return input_error("name a built-in scene", "", "one of " + known);
  return input_error("there is no built-in scene '" + std::string(name) + "'", "",
                     "choose one of " + known);
}

}  // namespace halflight
