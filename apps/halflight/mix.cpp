// halflight mix CHECKPOINT --group NAME=FACTOR: dims and recolours lights without solving again.
#include <charconv>
#include <memory>

#include <fmt/format.h>

#include "checkpoint_arguments.h"
#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/solve/mix.h"
#include "lit_output.h"
#include "number_checks.h"
#include "sensor_arguments.h"

namespace halflight::app {
namespace {

struct MixArguments {
  CheckpointArguments checkpoint;
  std::vector<std::string> groups;
  SensorArguments sensors;
  LitArguments lit;
  int threads = 0;
};

// One number for all channels, or three with commas between.
bool parse_factor(std::string_view text, Rgb& factor) {
  int count = 0;
  while (count < 3) {
    const std::size_t end = std::min(text.find(','), text.size());
    float& value = factor[count++];
    const auto [stop, error] = std::from_chars(text.data(), text.data() + end, value);
    if (error != std::errc() || stop != text.data() + end ||
        !(value >= 0.f && value <= kLargestFactor))
      return false;
    if (end == text.size()) break;
    text.remove_prefix(end + 1);
    if (count == 3) return false;
  }
  if (count == 1) factor = Rgb(factor.r);
  return count != 2;
}

std::string names_of(const std::vector<LightGroup>& groups) {
  std::string names;
  for (const LightGroup& g : groups) names += (names.empty() ? "" : ", ") + g.name;
  return names;
}

// Groups that are not named stay as the scene says.
Result<std::vector<Rgb>> factors_of(const MixArguments& arguments,
                                    const std::vector<LightGroup>& groups) {
  std::vector<Rgb> factors(groups.size(), Rgb(1.f));
  for (const std::string& text : arguments.groups) {
    const std::size_t equals = text.rfind('=');
    Rgb factor(1.f);
    if (equals == std::string::npos ||
        !parse_factor(std::string_view(text).substr(equals + 1), factor))
      return input_error(fmt::format("'{}' is not a group and its factor", text), "--group",
                         "write NAME=0.5 or NAME=1,0.8,0.6");
    std::size_t g = 0;
    while (g < groups.size() && groups[g].name != text.substr(0, equals)) ++g;
    if (g == groups.size())
      return input_error(fmt::format("there is no light group '{}'", text.substr(0, equals)),
                         "--group", fmt::format("the checkpoint has {}", names_of(groups)));
    factors[g] = factor;
  }
  return factors;
}

Result<void> mix_groups(const CLI::App& command, const MixArguments& arguments) {
  if (auto ok = check(arguments.lit); !ok) return ok;
  CommandFiles files;
  add_files(files, arguments.sensors);
  add_files(files, arguments.lit);
  add_files(files, arguments.checkpoint);
  if (auto ok = check(files); !ok) return ok;
  const auto sensors = read_sensors(arguments.sensors);
  if (!sensors) return tl::unexpected(sensors.error());
  warn_of_idle_sensors(command);
  Result<SolverState> state = restore(arguments.checkpoint, files);
  if (!state) return tl::unexpected(state.error());
  if (state->grouped.groups.empty())
    return input_error("the checkpoint has no light groups", arguments.checkpoint.path.string(),
                       "solve with --light-groups");
  const auto factors = factors_of(arguments, state->grouped.groups);
  if (!factors) return tl::unexpected(factors.error());
  if (arguments.sensors.points.empty() && arguments.lit.path.empty())
    warn("nothing will be written (add -o lit.glb or --points)");
  relight(*state, *factors);
  mix(*state, *factors);
  return write_readings(arguments.sensors, *sensors, arguments.lit, *state);
}

}  // namespace

void add_mix(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<MixArguments>();
  CLI::App& command = *cli.add_subcommand("mix", "dims and recolours the lights of a solved scene");
  add_checkpoint_arguments(command, arguments->checkpoint);
  command
      .add_option("--group", arguments->groups,
                  "multiplies the light of a group by a number or by r,g,b; may be repeated")
      ->type_name("NAME=FACTOR")
      ->expected(1)
      ->take_all();
  add_sensor_arguments(command, arguments->sensors);
  add_lit_arguments(command, arguments->lit);
  add_threads(command, arguments->threads);
  command.callback([arguments, &command, &status] {
    set_thread_count(arguments->threads);
    const Result<void> done = mix_groups(command, *arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
