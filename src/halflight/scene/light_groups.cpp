#include "halflight/scene/light_groups.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

namespace halflight {
namespace {

// Groups in the order in which their names come first.
class GroupsByName {
 public:
  // The group of that name, which is appended when there is none yet.
  LightGroup& operator[](const std::string& name) {
    const auto [known, added] = index_.emplace(name, groups_.size());
    if (added) groups_.push_back({name, {}, {}, false});
    return groups_[known->second];
  }
  // Null when there is none.
  LightGroup* find(const std::string& name) {
    const auto known = index_.find(name);
    return known == index_.end() ? nullptr : &groups_[known->second];
  }
  std::vector<LightGroup>& all() { return groups_; }

 private:
  std::vector<LightGroup> groups_;
  std::unordered_map<std::string, std::size_t> index_;
};

template <class IdT>
std::string name_or_number(const std::string& name, const char* kind, IdT id) {
  return name.empty() ? fmt::format("{} {}", kind, id.value) : name;
}

GroupsByName one_for_each_name(const Scene& scene) {
  IdVector<MaterialId, std::uint8_t> used(scene.materials.size(), 0);
  IdVector<LightId, std::uint8_t> placed(scene.lights.size(), 0);
  for (const Node& node : scene.nodes) {
    if (node.light.valid()) placed[node.light] = 1;
    if (!node.mesh.valid()) continue;
    for (const Primitive& p : scene.meshes[node.mesh].primitives) used[p.material] = 1;
  }
  GroupsByName groups;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const MaterialId id(i);
    const Material& m = scene.materials[id];
    if (used[id] && m.emits())
      groups[name_or_number(m.name, "material", id)].materials.push_back(id);
  }
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const LightId id(i);
    const Light& light = scene.lights[id];
    if (placed[id] && max_component(light.intensity) > 0.f)
      groups[name_or_number(light.name, "light", id)].lights.push_back(id);
  }
  if (max_component(scene.sky) > 0.f) groups["sky"].sky = true;
  return groups;
}

std::string names_of(const std::vector<LightGroup>& groups) {
  std::string names;
  for (const LightGroup& g : groups) names += (names.empty() ? "" : ", ") + g.name;
  return names.empty() ? "nothing that shines" : names;
}

// Takes what comes before the separator off the front of the text.
std::string_view next_part(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

void append(LightGroup& to, LightGroup& from) {
  to.materials.insert(to.materials.end(), from.materials.begin(), from.materials.end());
  to.lights.insert(to.lights.end(), from.lights.begin(), from.lights.end());
  to.sky = to.sky || from.sky;
  from = {};
}

}  // namespace

Result<std::vector<LightGroup>> find_light_groups(const Scene& scene, std::string_view together) {
  GroupsByName each = one_for_each_name(scene);
  const std::string names = names_of(each.all());
  std::vector<LightGroup> groups;
  while (!together.empty()) {
    std::string_view members = next_part(together, ';');
    const std::string text(members);
    const bool named = members.find('=') != std::string_view::npos;
    LightGroup group;
    group.name = next_part(members, '=');
    if (!named || group.name.empty() || members.empty())
      return input_error(fmt::format("'{}' is no group of lights", text), "--light-groups",
                         "write it as \"ceiling=LampA,LampB;desk=LampC\"");
    while (!members.empty()) {
      const std::string name(next_part(members, ','));
      LightGroup* const found = each.find(name);
      if (!found || found->empty())
        return input_error(fmt::format("nothing named '{}' is left that shines", name),
                           "--light-groups", "there is " + names);
      append(group, *found);
    }
    groups.push_back(group);
  }
  for (LightGroup& g : each.all())
    if (!g.empty()) groups.push_back(std::move(g));
  std::unordered_set<std::string_view> taken;
  for (const LightGroup& g : groups)
    if (!taken.insert(g.name).second)
      return input_error(fmt::format("two groups are called '{}'", g.name), "--light-groups",
                         "choose another name");
  return groups;
}

Scene with_factors(Scene scene, std::span<const LightGroup> groups, std::span<const Rgb> factors) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const MaterialId m : groups[i].materials) scene.materials[m].emission *= factors[i];
    for (const LightId l : groups[i].lights) scene.lights[l].intensity *= factors[i];
    if (groups[i].sky) scene.sky *= factors[i];
  }
  return scene;
}

}  // namespace halflight
