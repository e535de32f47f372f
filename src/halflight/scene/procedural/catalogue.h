// All built-in scenes by name.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/base/result.h"
#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

// A built-in scene with parameters of its own: turn the knobs, then build.
struct Recipe {
  std::string name;
  std::string summary;  // one line
  Knobs knobs;
  std::function<Scene()> build;
};

// Fresh recipes with default parameters, in the order of the documentation.
std::vector<Recipe> scene_recipes();
// An unknown name is an error that lists the known ones.
Result<Recipe> find_recipe(std::string_view name);

}  // namespace halflight
