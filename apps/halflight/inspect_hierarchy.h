// What inspect tells of cluster trees.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "halflight/scene/scene.h"
#include "halflight/visibility/hierarchy_measures.h"

namespace halflight::app {

struct InspectedHierarchy {
  std::string name;
  double build_seconds = 0.0;  // all cores, without finding the surfaces
  HierarchyMeasures measures;
};

std::vector<std::string> hierarchy_choices();  // the builders' names, and "all"
std::vector<InspectedHierarchy> inspect_hierarchies(const Scene& scene, const std::string& choice);
nlohmann::json hierarchies_json(const std::vector<InspectedHierarchy>& hierarchies);
void print_hierarchies(const std::vector<InspectedHierarchy>& hierarchies);

}  // namespace halflight::app
