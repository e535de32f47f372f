#include "halflight/solve/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <new>

#include <fmt/format.h>

#include "halflight/scene/radiance.h"
#include "halflight/scene/scene_digest.h"
#include "halflight/solve/cells.h"
#include "halflight/solve/checkpoint_fields.h"
#include "halflight/solve/mix.h"
#include "halflight/solve/settings.h"

namespace halflight {
namespace {

constexpr double kLargestShare = 0.05;  // of the time that goes into writing

struct Placement {
  double metres_per_unit = 1.0;
  std::int64_t z_up = 0;
};

// Replayed on a fresh tree these make the same cells, to the bit.
std::vector<ElementId> splits_of(const ElementTree& tree) {
  std::vector<ElementId> splits;
  for (std::size_t i = tree.initial_size(); i < tree.size(); ++i) {
    const ElementId parent = tree[ElementId(i)].parent;
    if (splits.empty() || splits.back() != parent) splits.push_back(parent);
  }
  return splits;
}

bool replay(SolverState& state, const std::vector<ElementId>& splits) {
  ElementTree& tree = state.tree;
  for (const ElementId e : splits) {
    if (e.value >= tree.size() || !tree[e].is_leaf_cell()) return false;
    if (!(tree.cell_size(e) > 2.f * finest_cell(state))) return false;
    tree.split(e);
    if (tree[e].is_leaf()) return false;
  }
  return true;
}

IdVector<SideId, std::uint8_t> live_sides_of(const SolverState& state) {
  IdVector<SideId, std::uint8_t> live(2 * state.surfaces->surfaces.size(), 0);
  for (std::size_t i = 0; i < live.size(); ++i)
    live[SideId(i)] = state.tree.side_root(SideId(i)).valid();
  return live;
}

std::string section_of_record(std::string_view field) { return fmt::format("history: {}", field); }

void write_history(const FieldWriter& write, const std::vector<IterationRecord>& history) {
  for_each_record_field([&](std::string_view name, auto member, const auto&... range) {
    std::vector<std::decay_t<decltype(history.front().*member)>> column;
    for (const IterationRecord& record : history) column.push_back(record.*member);
    write(section_of_record(name), column, range...);
  });
}

// False where the columns are not all as long.
bool read_history(const FieldReader& read, std::vector<IterationRecord>& history) {
  bool equal = true, first = true;
  for_each_record_field([&](std::string_view name, auto member, const auto&... range) {
    std::vector<std::decay_t<decltype(std::declval<IterationRecord>().*member)>> column;
    read(section_of_record(name), column, range...);
    if (first) history.resize(column.size());
    first = false;
    equal = equal && column.size() == history.size();
    for (std::size_t i = 0; equal && i < column.size(); ++i) history[i].*member = column[i];
  });
  return equal;
}

std::string to_text(const Rgb& c) { return fmt::format("{},{},{}", c.r, c.g, c.b); }

std::string number_of(std::size_t group) { return fmt::format("group {}", group); }

// Whether what was sound one by one fits together.
bool fits_together(const SolverState& state) {
  const Schedule& todo = state.schedule;
  const auto waiting = todo.receivers.size();
  return todo.level <= state.options.levels + 1 && waiting <= todo.receiver_total &&
         todo.receiver_total <= state.tree.size() && (waiting == 0 || todo.round > 0) &&
         todo.pairs.size() <= std::max<std::size_t>(1, state.links.size()) &&
         std::ranges::all_of(state.sampled.raw(), [&](auto round) { return round <= todo.round; });
}

// Names and members; the light only once it is known.
void write_groups(SectionWriter& file, const FieldWriter& write, const GroupedLight& grouped) {
  write("groups", grouped.factors);
  for (std::size_t g = 0; g < grouped.groups.size(); ++g) {
    const LightGroup& group = grouped.groups[g];
    const std::string name = number_of(g);
    file.add(name, std::string_view(group.name));
    write(name + " materials", group.materials);
    write(name + " lights", group.lights);
    write(name + " sky", group.sky ? 1 : 0);
  }
  write("groups separated", grouped.separated() ? 1 : 0);
  if (!grouped.separated()) return;
  write("groups' exitance", grouped.exitance);
  for (std::size_t g = 0; g < grouped.light.size(); ++g) {
    write(number_of(g) + " given light", grouped.light[g].given_light);
    write(number_of(g) + " irradiance", grouped.light[g].irradiance);
  }
}

Result<void> read_groups(const SectionReader& file, const FieldReader& read, const Scene& scene,
                         GroupedLight& grouped) {
  read("groups", grouped.factors, {0.0, double{kLargestFactor}});
  grouped.groups.resize(grouped.factors.size());
  for (std::size_t g = 0; g < grouped.groups.size(); ++g) {
    LightGroup& group = grouped.groups[g];
    const std::string name = number_of(g);
    const auto text = file.text(name);
    if (!text) return tl::unexpected(text.error());
    group.name = *text;
    int sky = 0;
    read(name + " materials", group.materials);
    read(name + " lights", group.lights);
    read(name + " sky", sky);
    group.sky = sky != 0;
    const auto known = [](const auto& ids, const auto& items) {
      return std::all_of(ids.begin(), ids.end(), [&](auto id) { return items.contains(id); });
    };
    if (!known(group.materials, scene.materials) || !known(group.lights, scene.lights))
      return file.damaged(name);
  }
  int separated = 0;
  read("groups separated", separated);
  if (separated == 0) return {};
  read("groups' exitance", grouped.exitance, kLight);
  grouped.light.resize(grouped.groups.size());
  for (std::size_t g = 0; g < grouped.light.size(); ++g) {
    read(number_of(g) + " given light", grouped.light[g].given_light, kLight);
    read(number_of(g) + " irradiance", grouped.light[g].irradiance, kLight);
  }
  return {};
}

// How a scene is placed and lit; the same limits as for what is asked for.
bool is_sound(const SceneSource& source) {
  return std::isfinite(source.load.metres_per_unit) && source.load.metres_per_unit > 0.0 &&
         is_radiance(source.sky);
}

// The options of the state are those asked for, but that it may aim at less error by now.
bool may_become(const SolveOptions& asked, SolveOptions present) {
  constexpr float kMostFiner = 1e6f;
  const bool finer = present.error <= asked.error && present.error * kMostFiner >= asked.error;
  present.error = asked.error;
  return asked.error >= kLeastError && finer && difference(asked, present).empty();
}

// What light groups need that is not in the file.
bool finish_groups(SolverState& state) {
  GroupedLight& grouped = state.grouped;
  const auto whole = [&](const auto& items) { return items.size() == state.tree.size(); };
  if (grouped.separated()) {
    bool complete = whole(grouped.exitance);
    for (const GroupLight& light : grouped.light)
      complete = complete && whole(light.given_light) && whole(light.irradiance);
    if (!complete) return false;
  }
  if (grouped.groups.empty()) return true;
  grouped.world = state.world;
  const std::vector<Rgb> factors = grouped.factors;
  if (std::any_of(factors.begin(), factors.end(), [](const Rgb& f) { return f != Rgb(1.f); }))
    relight(state, factors);
  return true;
}

constexpr const char* kGiveTheSame =
    "give the same options, or solve anew without --resume to another file";

}  // namespace

Result<void> write_checkpoint(const std::filesystem::path& path, const SolveOrigin& origin,
                              const SolverState& state) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path from = fs::weakly_canonical(fs::absolute(path, error).parent_path(), error);
  const fs::path scene = fs::weakly_canonical(fs::absolute(origin.scene.path, error), error);
  const fs::path relative = scene.lexically_proximate(from);

  SectionWriter file;
  file.add("scene", std::string_view(relative.generic_string()));
  file.add_value("placement", Placement{origin.scene.load.metres_per_unit,
                                        origin.scene.load.up == UpAxis::z ? 1 : 0});
  file.add_value("sky", origin.scene.sky);
  file.add_value("scene's fingerprint", origin.scene_digest);
  file.add("settings asked for", std::string_view(to_text(origin.options)));
  file.add("settings", std::string_view(to_text(state.options)));
  file.add("live sides", live_sides_of(state).raw());
  file.add("splits", splits_of(state.tree));
  const FieldWriter write(file, state.tree);
  for_each_field(state, write);
  write_history(write, state.history);
  write_groups(file, write, state.grouped);
  return file.write(path);
}

Result<Checkpoint> Checkpoint::open(const std::filesystem::path& path) {
  auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse(std::move(*bytes), path);
}

Result<Checkpoint> Checkpoint::parse(Bytes bytes, const std::filesystem::path& path) {
  auto sections = SectionReader::parse(std::move(bytes), path.string());
  if (!sections) return tl::unexpected(sections.error());
  Checkpoint checkpoint;
  checkpoint.path_ = path;
  checkpoint.sections_ = std::move(*sections);
  const SectionReader& file = checkpoint.sections_;

  const auto scene = file.text("scene");
  const auto asked_text = file.text("settings asked for");
  const auto text = file.text("settings");
  const auto placement = file.array<Placement>("placement");
  const auto sky = file.array<Rgb>("sky");
  const auto digest = file.array<std::uint64_t>("scene's fingerprint");
  for (const auto* failed :
       {scene ? nullptr : &scene.error(), asked_text ? nullptr : &asked_text.error(),
        text ? nullptr : &text.error(), placement ? nullptr : &placement.error(),
        sky ? nullptr : &sky.error(), digest ? nullptr : &digest.error()})
    if (failed) return tl::unexpected(*failed);
  if (placement->size() != 1 || sky->size() != 1 || digest->size() != 1)
    return file.damaged("scene");
  const auto asked = parse_settings(*asked_text), options = parse_settings(*text);
  if (!asked || !options || !may_become(*asked, *options)) return file.damaged("settings");

  SceneSource& source = checkpoint.origin_.scene;
  source.path = path.parent_path() / *scene;
  source.load.metres_per_unit = placement->front().metres_per_unit;
  source.load.up = placement->front().z_up != 0 ? UpAxis::z : UpAxis::y;
  source.sky = sky->front();
  if (!is_sound(source)) return file.damaged("placement");
  checkpoint.origin_.scene_digest = digest->front();
  checkpoint.origin_.options = *asked;
  checkpoint.options_ = *options;
  return checkpoint;
}

Result<Scene> Checkpoint::load_scene(const std::filesystem::path& instead) const {
  const SceneSource& source = origin_.scene;
  const std::filesystem::path& path = instead.empty() ? source.path : instead;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return input_error(fmt::format("the scene that was solved is not at {}", path.string()),
                       path_.string(), "say where it is with --scene");
  auto scene = halflight::load_scene(path, source.load);
  if (!scene) return scene;
  scene->sky = source.sky;
  if (digest_of(*scene) != origin_.scene_digest)
    return input_error(fmt::format("{} is not the scene that was solved", path.string()),
                       path_.string(), "it has changed since: solve it again");
  return scene;
}

Result<void> Checkpoint::check(const SolveOrigin& wanted) const {
  const SceneSource &there = origin_.scene, &here = wanted.scene;
  const auto other = [&](const std::string& what) {
    return input_error("the checkpoint is of another solve: " + what, path_.string(), kGiveTheSame);
  };
  if (there.load.metres_per_unit != here.load.metres_per_unit)
    return other(fmt::format("its unit is {} m, not {} m", there.load.metres_per_unit,
                             here.load.metres_per_unit));
  if (there.load.up != here.load.up) return other("another axis points up");
  if (there.sky != here.sky)
    return other(fmt::format("its sky is {}, not {}", to_text(there.sky), to_text(here.sky)));
  if (origin_.scene_digest != wanted.scene_digest)
    return input_error(
        fmt::format("the checkpoint is of another scene than {}, or that has changed since",
                    here.path.string()),
        path_.string(), "solve anew without --resume");
  if (const std::string what = difference(origin_.options, wanted.options); !what.empty())
    return other(what);
  return {};
}

Result<SolverState> Checkpoint::restore(const std::shared_ptr<const World>& world) const {
  try {
    auto live = sections_.array<std::uint8_t>("live sides");
    if (!live) return tl::unexpected(live.error());
    const auto splits = sections_.array<ElementId>("splits");
    if (!splits) return tl::unexpected(splits.error());
    const auto surfaces = std::make_shared<const Surfaces>(build_surfaces(world->geometry));
    if (live->size() != 2 * surfaces->surfaces.size()) return sections_.damaged("live sides");
    IdVector<SideId, std::uint8_t> live_sides;
    live_sides.raw() = std::move(*live);
    SolverState state = make_state(world, surfaces, live_sides, options_);
    if (!replay(state, *splits)) return sections_.damaged("splits");
    state.feature_sizes = state.feature_size_rules->of_elements(state.tree);
    const FieldReader read(sections_, state.tree);
    for_each_field(state, read);
    const bool equal = read_history(read, state.history);
    if (auto groups = read_groups(sections_, read, world->scene, state.grouped); !groups)
      return tl::unexpected(groups.error());
    if (!read.result()) return tl::unexpected(read.result().error());
    if (!equal) return sections_.damaged("history");
    if (!fits_together(state)) return sections_.damaged("schedule");
    if (state.schedule.round > 0)
      state.emitters =
          std::make_shared<EmitterTree>(*state.visibility, find_emitters(*state.world));
    if (!finish_groups(state)) return sections_.damaged("groups");
    return state;
  } catch (const std::bad_alloc&) {
    return system_error("there is not enough memory to read the checkpoint", path_.string(),
                        "use a larger machine");
  }
}

Result<void> CheckpointKeeper::save(const SolverState& state) {
  const auto present = std::pair(state.history.size(), state.grouped.separated());
  if (saved_ == present) return {};
  const auto start = Clock::now();
  if (auto written = write_checkpoint(path_, origin_, state); !written) return written;
  const auto end = Clock::now();
  saved_ = present;
  due_ = end + std::chrono::duration_cast<Clock::duration>((end - start) / kLargestShare);
  return {};
}

Result<void> CheckpointKeeper::save_if_due(const SolverState& state) {
  return Clock::now() >= due_ ? save(state) : Result<void>();
}

}  // namespace halflight
