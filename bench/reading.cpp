// What it costs to read direct light at the vertices of a lit mesh by exact and by multi-resolution
// rays, and how large the errors are, as the number of shadow rays grows.
//
//   halflight scene plants --count 524288 -o plants.glb
//   bench_reading plants.glb 0.02
//
// The second argument is the feature size as a share of the scene's diagonal. "us" are microseconds
// of processor time for each point, of vertices (middles of triangles drawn at random, both sides)
// and of the pixels of a view of the floor from above. Errors are against many exact rays, as
// shares of the mean: RMS of single vertices, L2 and FBEM(s) of the floor. "gather" is the reading
// of reflected light, whose rays are exact in every mode.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "experiments/feature_study.h"
#include "halflight/base/parallel.h"
#include "halflight/io/load_scene.h"
#include "halflight/rays/sampling.h"

namespace halflight::experiments {
namespace {

constexpr std::size_t kVertices = 20000;
constexpr int kPixels = 128;
constexpr float kFromHeight = 0.6f;  // of the scene's
struct RayNumbers {
  int shadow, penumbra;
};
constexpr std::array kTried{RayNumbers{4, 4}, RayNumbers{8, 8}, RayNumbers{8, 24},
                            RayNumbers{16, 64}};
constexpr RayNumbers kReference{256, 1024};

std::vector<ReadingPoint> some_vertices(const Geometry& g) {
  std::vector<ReadingPoint> points;
  for (std::size_t i = 0; i < kVertices; ++i) {
    const TriangleId t(static_cast<std::size_t>(hash(i / 2, 7) % g.triangles.size()));
    const Vec3 n = glm::normalize(g.scaled_normal(t));
    points.push_back({g.point(t, Vec2(1.f / 3.f)), i % 2 == 0 ? n : -n, t});
  }
  return points;
}

ReadOptions reading_with(const RayNumbers& rays) {
  ReadOptions options = kMeshReading;
  options.direct.shadow_rays = rays.shadow;
  options.direct.penumbra_rays = rays.penumbra;
  return options;
}

struct DirectLightRead {
  std::vector<float> irradiance;
  double microseconds = 0, rays = 0;  // for each point
};
DirectLightRead read_direct(const SolverState& state, const SolutionReader& reader,
                            const std::vector<ReadingPoint>& points) {
  DirectLightRead read;
  read.irradiance.resize(points.size());
  const auto rays = [&] { return state.world->rays.ray_total() + state.visibility->ray_total(); };
  const std::uint64_t before = rays();
  const std::clock_t start = std::clock();
  parallel_for(points.size(), 64, [&](std::size_t i) {
    if (points[i].triangle.valid())
      read.irradiance[i] = average(reader.direct(points[i].position, points[i].normal));
  });
  const auto count = static_cast<double>(points.size());
  read.microseconds = 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / count;
  read.rays = static_cast<double>(rays() - before) / count;
  return read;
}

double gather_microseconds(const SolutionReader& reader, const std::vector<ReadingPoint>& points,
                           double direct) {
  const std::clock_t start = std::clock();
  reader(points);
  const double all = 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return all / static_cast<double>(points.size()) - direct;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += static_cast<double>((a[i] - b[i]) * (a[i] - b[i]));
    mean += static_cast<double>(b[i]);
  }
  const auto count = static_cast<double>(a.size());
  return std::sqrt(squares / count) / (mean / count);
}

Image grey(const FlatView& view, const std::vector<float>& values) {
  Image picture(view.width, view.height);
  for (std::size_t i = 0; i < values.size(); ++i) picture.pixels[i] = Rgb(values[i]);
  return picture;
}

Result<void> compare_readings(const char* file, double share) {
  Result<Scene> scene = load_scene(file);
  if (!scene) return tl::unexpected(scene.error());
  const auto world = make_world(std::move(*scene));
  const std::vector<ReadingPoint> vertices = some_vertices(world->geometry);
  const FlatView floor = view_of_floor(*world, kFromHeight, kPixels);
  const BinaryImage shadow = shadow_in(floor, PathTracer(*world), 32);
  SolveOptions options;
  options.feature_size = static_cast<float>(share) * world->geometry.bounds.diagonal();
  DirectLightRead true_vertices, true_floor;
  fmt::print(
      "| visibility | rays | us, vertex | rays, vertex | RMS | us, floor | rays, floor | L2 | "
      "FBEM(s) | us, gather |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const auto mode : {VisibilityMode::exact, VisibilityMode::multires}) {
    options.visibility = mode;
    const SolverState state = make_state(world, options);
    if (mode == VisibilityMode::exact) {
      const SolutionReader reader(state, reading_with(kReference));
      true_vertices = read_direct(state, reader, vertices);
      true_floor = read_direct(state, reader, floor.points);
    }
    for (const RayNumbers& tried : kTried) {
      const SolutionReader reader(state, reading_with(tried));
      const DirectLightRead at_vertices = read_direct(state, reader, vertices);
      const DirectLightRead on_floor = read_direct(state, reader, floor.points);
      const StudyError error =
          judge(floor, grey(floor, true_floor.irradiance), grey(floor, on_floor.irradiance), shadow,
                options.feature_size);
      fmt::print(
          "| {} | {}-{} | {:.1f} | {:.1f} | {:.1f} % | {:.1f} | {:.1f} | {:.1f} % | {:.1f} % | "
          "{:.0f} |\n",
          name_of(state.visibility->mode()), tried.shadow, tried.penumbra, at_vertices.microseconds,
          at_vertices.rays, 100.0 * rms(at_vertices.irradiance, true_vertices.irradiance),
          on_floor.microseconds, on_floor.rays, 100.0 * error.l2, 100.0 * error.fbem,
          gather_microseconds(reader, vertices, at_vertices.microseconds));
      std::fflush(stdout);
    }
  }
  return {};
}

}  // namespace
}  // namespace halflight::experiments

int main(int count, char** arguments) {
  if (count != 3) {
    fmt::print(stderr, "usage: bench_reading SCENE SHARE\n");
    return 1;
  }
  const auto done = halflight::experiments::compare_readings(arguments[1], std::atof(arguments[2]));
  if (!done) fmt::print(stderr, "{}: {}\n", arguments[1], done.error().what);
  return done ? 0 : 1;
}
