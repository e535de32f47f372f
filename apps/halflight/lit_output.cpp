#include "lit_output.h"

#include <charconv>
#include <chrono>

#include <fmt/format.h>

#include "commands.h"
#include "halflight/io/image_write.h"
#include "halflight/io/write_gltf.h"
#include "halflight/output/bake_lightmap.h"
#include "halflight/output/exposure.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/read_light.h"
#include "halflight/solve/memory.h"
#include "terminal_progress.h"

namespace halflight::app {
namespace {

constexpr std::size_t kBytesOfTexel = 110;  // of a lightmap, until its files are written

Result<int> lightmap_size(const std::string& text) {
  int size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error == std::errc() && end == text.data() + text.size() && size >= kLeastLightmapSize &&
      size <= kMostLightmapSize)
    return size;
  return input_error(fmt::format("--lightmap '{}' is not a number of texels from {} to {}", text,
                                 kLeastLightmapSize, kMostLightmapSize),
                     {}, "write it like 1024");
}

std::filesystem::path beside(const std::filesystem::path& lit, const char* ending) {
  return std::filesystem::path(lit).replace_extension(ending);
}

Result<void> write_pictures(const std::filesystem::path& lit, const Lightmap& map, float exposure) {
  Result<void> written = write_image(beside(lit, "lightmap.exr"), map.irradiance);
  Image shown = map.irradiance;
  for (Rgb& texel : shown.pixels) texel *= exposure / kPi;
  also(written, write_image(beside(lit, "lightmap.png"), shown));
  return written;
}

Result<Lightmap> bake(int size, const SolverState& state, const SolutionReader& reader,
                      LitMesh& mesh, const Progress& progress) {
  const LightmapLight light{
      .read = [&](std::span<const ReadingPoint> points) { return reader(points, progress); },
      .covered = [&](std::span<const ReadingPoint> points) { return reader.covered(points); }};
  return bake_lightmap(state.world->scene, state.world->geometry, mesh.primitives, light,
                       state.options.feature_size, size, progress);
}

}  // namespace

void add_lit_arguments(CLI::App& command, LitArguments& arguments) {
  CLI::Option* output = command.add_option("-o,--output", arguments.path, "lit scene, GLB")
                            ->check(file_name())
                            ->type_name("lit.glb");
  command
      .add_option("--lightmap", arguments.lightmap,
                  "also write the irradiance as a picture of SIZE x SIZE texels on the lit scene's "
                  "TEXCOORD_1: lit.lightmap.exr, and lit.lightmap.png to look at")
      ->type_name("SIZE")
      ->needs(output);
}

Result<void> check(const LitArguments& arguments) {
  if (arguments.lightmap)
    if (const auto size = lightmap_size(*arguments.lightmap); !size)
      return tl::unexpected(size.error());
  return {};
}

void add_files(CommandFiles& files, const LitArguments& arguments) {
  files.writes("-o", arguments.path);
  if (!arguments.lightmap) return;
  for (const char* ending : {"lightmap.exr", "lightmap.png"})
    files.writes("--lightmap", beside(arguments.path, ending));
}

std::size_t least_memory(const LitArguments& arguments, std::size_t vertices) {
  if (arguments.path.empty()) return 0;
  std::size_t bytes = bytes_of_lit_mesh(vertices);
  if (!arguments.lightmap) return bytes;
  const auto size = lightmap_size(*arguments.lightmap);
  const auto side = static_cast<std::size_t>(size ? *size : 0);
  return bytes + side * side * kBytesOfTexel;
}

LitMeshOptions lit_mesh_options(const SolverState& state, const LitArguments& arguments) {
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  options.finest = finest_mesh_edge(state);
  if (state.options.memory == 0) return options;
  const std::size_t used = counted_bytes(state) + least_memory(arguments, 0);
  const std::size_t left = state.options.memory - std::min(state.options.memory, used);
  options.max_vertices = std::min(options.max_vertices, left / bytes_of_lit_mesh(1));
  return options;
}

Result<void> write_lit(const LitArguments& arguments, const SolverState& state, Report& report,
                       const Progress& progress) {
  const World& world = *state.world;
  const SolutionReader reader(state, kMeshReading);
  auto phase = std::chrono::steady_clock::now();
  LitMesh mesh = build_lit_mesh(
      world.scene, world.geometry,
      [&](std::span<const ReadingPoint> points) { return reader(points, progress); },
      lit_mesh_options(state, arguments), progress);
  report.end_phase("lit mesh", phase);
  const float exposure = automatic_exposure(world.scene, world.geometry, mesh.primitives);

  LightmapFile file;
  Result<void> baked;
  if (arguments.lightmap) {
    phase = std::chrono::steady_clock::now();
    const auto size = lightmap_size(*arguments.lightmap);
    if (!size) return tl::unexpected(size.error());
    const auto map = bake(*size, state, reader, mesh, progress);
    report.end_phase("lightmap", phase);
    if (map) {
      file = {beside(arguments.path, "lightmap.exr").filename().string(), *size};
      report.set_lightmap(*map);
      baked = write_pictures(arguments.path, *map, exposure);
    } else {
      baked = tl::unexpected(map.error());
    }
  }
  phase = std::chrono::steady_clock::now();
  auto written =
      write_lit_glb(arguments.path, world.scene, world.geometry, mesh.primitives, exposure, file);
  report.end_phase("write lit", phase);
  report.set_lit_mesh(mesh, exposure);
  also(baked, written);
  return baked;
}

Result<void> write_readings(const SensorArguments& sensor_arguments,
                            std::span<const Sensor> sensors, const LitArguments& lit,
                            const SolverState& state) {
  Result<void> written;
  if (!sensors.empty()) also(written, write_irradiance(sensor_arguments, state, sensors));
  if (lit.path.empty()) return written;
  Report report;
  also(written, write_lit(lit, state, report, Progress(terminal_progress())));
  return written;
}

}  // namespace halflight::app
