// Wall time and processor time to an error of irradiance at many sensors, beside the path tracer on
// the same machine in the same run.
//
//   bench_time_to_error [--sensors FILE] SENSORS SCENE...
//
// --sensors keeps them, one a line with both truths behind: x y z nx ny nz E E (of the last
// scene), and takes the truths from there where the file holds as many. Sensors lie at random over
// the sides that can see light, by area. Times start when the scene is loaded and its ray structure
// built, which both need. NRMSE is free of the truth's own noise: two independent path-traced
// estimates are subtracted from what is judged, and the two differences multiplied. Their paths go
// where a pilot was noisy: a few bright places make most of an error. Median: of |E - truth| /
// max(truth, 1 % of the mean). Small: the NRMSE of the sensors on sides that are small beside the
// scene, by their own mean (loose triangles in a room). One line of JSON for each setting, then the
// time at which each error is reached: ours between two of the settings, the path tracer's from its
// last one, as its error falls with the root of time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <thread>

#include "halflight/base/parallel.h"
#include "halflight/hierarchy/live_sides.h"
#include "halflight/io/load_scene.h"
#include "halflight/output/read_light.h"
#include "halflight/rays/path_tracer.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::array kTargets{0.1, 0.05, 0.02, 0.01};
constexpr std::size_t kPathsOfTruth = 1 << 23;    // of all sensors together, in each of the two
constexpr std::size_t kFewestPathsOfTruth = 128;  // of a sensor, on average
constexpr int kPilotPaths = 32;
constexpr std::size_t kTracedAgain = 256;  // one in so many, for a quarter of all paths
constexpr double kSmallSide = 1e-3;        // of the area of all sides
constexpr std::array kPaths{4, 16, 64};
constexpr double kLongest =
    60.0;  // processor seconds: no slower setting after one that takes so long

struct Setting {
  float error;      // that the solve and the reading of direct light aim at
  int gather_rays;  // of indirect light
};
constexpr std::array kSettings{Setting{0.2f, 0},    Setting{0.5f, 32},   Setting{0.2f, 32},
                               Setting{0.2f, 64},   Setting{0.2f, 128},  Setting{0.1f, 64},
                               Setting{0.1f, 128},  Setting{0.05f, 256}, Setting{0.05f, 1024},
                               Setting{0.02f, 2560}};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Sensors {
  std::vector<ReadingPoint> points;
  std::vector<std::uint8_t> small;  // 1: on a small side
};

Sensors scatter(const World& world, std::size_t count) {
  const Geometry& g = world.geometry;
  const Surfaces surfaces = build_surfaces(g);
  const auto live = find_live_sides(world.scene, g, surfaces, world.rays);
  std::vector<double> before{0.0};
  for (std::size_t i = 0; i < live.size(); ++i)
    before.push_back(before.back() +
                     (live[SideId(i)] ? static_cast<double>(surfaces[SideId(i)].area) : 0.0));
  Sensors sensors;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(to_unit_float(hash(i, 1))) * before.back();
    const auto found = std::upper_bound(before.begin(), before.end(), at) - before.begin() - 1;
    const SideId side(std::min<std::size_t>(static_cast<std::size_t>(found), live.size() - 1));
    const Surface& s = surfaces[side];
    const auto* areas = &surfaces.cumulative_area[s.first_triangle];
    const float part = to_unit_float(hash(i, 2)) * s.area;
    const auto k = std::min<std::ptrdiff_t>(
        std::upper_bound(areas, areas + s.triangle_count, part) - areas, s.triangle_count - 1);
    const TriangleId t = surfaces.triangles[s.first_triangle + static_cast<std::size_t>(k)];
    sensors.points.push_back(
        {g.point(t, uniform_triangle(random_shift(hash(i, 3)))), surfaces.normal(side), t});
    sensors.small.push_back(static_cast<double>(s.area) < kSmallSide * before.back());
  }
  return sensors;
}

// paths(i): of sensor i.
template <class Paths>
std::vector<IrradianceEstimate> estimate(const World& world,
                                         const std::vector<ReadingPoint>& points,
                                         const Paths& paths, std::uint64_t seed) {
  const PathTracer tracer(world);
  std::vector<IrradianceEstimate> estimates(points.size());
  parallel_for(points.size(), 16, [&](std::size_t i) {
    estimates[i] = tracer.estimate_irradiance(points[i].position, points[i].normal,
                                              static_cast<std::uint32_t>(paths(i)), hash(seed, i));
  });
  return estimates;
}

std::vector<float> means_of(const std::vector<IrradianceEstimate>& estimates) {
  std::vector<float> means;
  for (const IrradianceEstimate& e : estimates) means.push_back(average(e.mean));
  return means;
}

struct Truth {
  std::vector<float> a, b;
  double mean = 0.0;
};

// Half of all paths evenly, the others by the noise of a pilot, which is then forgotten. Where the
// two differ most a rare bright path has been met, and both are traced again by many more.
Truth find_truth(const World& world, const std::vector<ReadingPoint>& points) {
  const auto pilot = estimate(
      world, points, [](std::size_t) { return kPilotPaths; }, 303);
  double noise = 0.0;
  for (const IrradianceEstimate& e : pilot) noise += static_cast<double>(average(e.standard_error));
  const auto all =
      static_cast<double>(std::max(kPathsOfTruth, kFewestPathsOfTruth * points.size()));
  const auto paths = [&](std::size_t i) {
    const double share = static_cast<double>(average(pilot[i].standard_error)) / noise;
    return 0.5 * all * ((noise > 0.0 ? share : 0.0) + 1.0 / static_cast<double>(points.size()));
  };
  Truth truth{means_of(estimate(world, points, paths, 101)),
              means_of(estimate(world, points, paths, 202))};
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) {
    const float a = std::abs(truth.a[i] - truth.b[i]), b = std::abs(truth.a[k] - truth.b[k]);
    return a > b || (a == b && i < k);
  });
  order.resize(points.size() / kTracedAgain);
  std::vector<ReadingPoint> doubtful;
  for (const std::size_t i : order) doubtful.push_back(points[i]);
  const auto many = [&](std::size_t) {
    return all / static_cast<double>(points.size()) * static_cast<double>(kTracedAgain / 4);
  };
  const auto a = means_of(estimate(world, doubtful, many, 404)),
             b = means_of(estimate(world, doubtful, many, 505));
  for (std::size_t k = 0; k < order.size(); ++k) {
    truth.a[order[k]] = a[k];
    truth.b[order[k]] = b[k];
  }
  return truth;
}

struct Judged {
  double nrmse = 0.0, median = 0.0;
  double small = 0.0;  // NRMSE of sensors on small sides
};
Judged judge(const std::vector<float>& values, const Truth& truth,
             const std::vector<std::uint8_t>& small) {
  double product = 0.0, product_small = 0.0, light_small = 0.0, count_small = 0.0;
  std::vector<double> relative;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto v = static_cast<double>(values[i]), a = static_cast<double>(truth.a[i]),
               b = static_cast<double>(truth.b[i]);
    product += (v - a) * (v - b);
    if (small[i] != 0) {
      product_small += (v - a) * (v - b);
      light_small += 0.5 * (a + b);
      count_small += 1.0;
    }
    relative.push_back(std::abs(v - 0.5 * (a + b)) / std::max(0.5 * (a + b), 0.01 * truth.mean));
  }
  std::nth_element(relative.begin(),
                   relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2),
                   relative.end());
  const auto rms = [](double sum, double count) {
    return std::sqrt(std::max(0.0, sum / std::max(1.0, count)));
  };
  return {rms(product, static_cast<double>(values.size())) / truth.mean,
          relative[relative.size() / 2],
          light_small > 0.0 ? rms(product_small, count_small) * count_small / light_small : 0.0};
}

struct Times {
  double wall = 0.0, cpu = 0.0;  // cpu: of all threads
};

class Stopwatch {
 public:
  Times read() const {
    return {seconds_since(start_), static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC};
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t cpu_start_ = std::clock();
};

struct Run {
  Times seconds;
  Judged error;
};
using Clock = double Times::*;

// Where the line through the fastest runs reaches the error, both scales logarithmic; none: never.
std::optional<double> seconds_to(const std::vector<Run>& runs, double target, Clock clock) {
  std::optional<double> best;
  for (const Run& a : runs) {
    const double start = a.seconds.*clock;
    if (a.error.nrmse <= target) best = std::min(best.value_or(start), start);
    for (const Run& b : runs) {
      const double end = b.seconds.*clock;
      if (!(a.error.nrmse > target && b.error.nrmse < target && end > start)) continue;
      const double t = std::log(a.error.nrmse / target) / std::log(a.error.nrmse / b.error.nrmse);
      const double seconds = start * std::pow(end / start, t);
      best = std::min(best.value_or(seconds), seconds);
    }
  }
  return best;
}

double seconds_of_paths(const Run& last, double target, Clock clock) {
  const double factor = last.error.nrmse / target;
  return last.seconds.*clock * factor * factor;
}

void print(const char* who, const std::string& setting, const Run& run) {
  fmt::print(R"({{"who": "{}", "setting": "{}", "seconds": {:.4f}, "cpu_seconds": {:.4f}, )"
             R"("nrmse": {:.5f}, "median": {:.5f}, "small": {:.5f}}})"
             "\n",
             who, setting, run.seconds.wall, run.seconds.cpu, run.error.nrmse, run.error.median,
             run.error.small);
  std::fflush(stdout);
}

void print_target(double target, const std::vector<Run>& ours, const Run& paths) {
  const auto number = [](std::optional<double> x) {
    return x ? fmt::format("{:.3f}", *x) : "null";
  };
  std::string line = fmt::format(R"({{"target": {})", target);
  for (const auto& [suffix, clock] :
       {std::pair{"", &Times::wall}, std::pair{"_cpu", &Times::cpu}}) {
    const std::optional<double> a = seconds_to(ours, target, clock);
    const double b = seconds_of_paths(paths, target, clock);
    line += fmt::format(R"(, "halflight{0}": {1}, "path_tracer{0}": {2:.3f}, "times{0}": {3})",
                        suffix, number(a), b, number(a ? std::optional(b / *a) : std::nullopt));
  }
  fmt::print("{}}}\n", line);
}

void write_sensors(const char* path, const std::vector<ReadingPoint>& points, const Truth& truth) {
  std::ofstream file(path);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i].position, n = points[i].normal;
    file << fmt::format("{} {} {} {} {} {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z, truth.a[i],
                        truth.b[i]);
  }
}

// Nothing where the file does not hold truths of as many sensors.
std::optional<Truth> read_truth(const char* path, std::size_t sensors) {
  std::ifstream file(path);
  Truth truth;
  std::array<double, 6> place{};
  float a = 0.f, b = 0.f;
  const auto read_place = [&] {
    for (double& x : place) file >> x;
    return static_cast<bool>(file >> a >> b);
  };
  while (read_place()) {
    truth.a.push_back(a);
    truth.b.push_back(b);
  }
  return truth.a.size() == sensors ? std::optional(truth) : std::nullopt;
}

int compare(std::size_t sensors, const char* path, const char* sensor_file) {
  auto scene = load_scene(path, {});
  if (!scene) {
    fmt::print(stderr, "{}: {}\n", path, scene.error().what);
    return 1;
  }
  const auto world = make_world(std::move(*scene));
  const Sensors scattered = scatter(*world, sensors);
  const std::vector<ReadingPoint>& points = scattered.points;
  fmt::print(R"({{"scene": "{}", "triangles": {}, "sensors": {}, "threads": {}}})"
             "\n",
             path, world->geometry.triangles.size(), points.size(), thread_count());

  std::optional<Truth> kept;
  if (sensor_file) kept = read_truth(sensor_file, points.size());
  Truth truth = kept ? *kept : find_truth(*world, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    truth.mean += 0.5 * static_cast<double>(truth.a[i] + truth.b[i]);
  truth.mean /= static_cast<double>(points.size());
  if (sensor_file && !kept) write_sensors(sensor_file, points, truth);

  std::vector<Run> ours;
  Run paths_traced;
  for (const Setting& setting : kSettings) {
    const Stopwatch watch;
    SolverState state = make_state(world, {.error = setting.error});
    while (!state.done()) advance(state, Progress());
    const double solved = watch.read().wall;
    ReadOptions options = sensor_reading(state);
    options.gather_rays = setting.gather_rays;
    const SolutionReader reader(state, options);
    std::vector<float> values;
    for (const Reading& r : reader(points)) values.push_back(average(r.irradiance()));
    ours.push_back({watch.read(), judge(values, truth, scattered.small)});
    print("halflight",
          fmt::format("error {:g} gather {} solve {:.3f} s", setting.error, options.gather_rays,
                      solved),
          ours.back());
    if (ours.back().seconds.cpu > kLongest) break;
  }
  for (const int paths : kPaths) {
    const Stopwatch watch;
    const std::vector<float> values = means_of(estimate(
        *world, points, [&](std::size_t) { return paths; }, 7));
    paths_traced = {watch.read(), judge(values, truth, scattered.small)};
    print("path tracer", fmt::format("{} paths", paths), paths_traced);
    if (paths_traced.seconds.cpu > kLongest) break;
  }
  for (const double target : kTargets) print_target(target, ours, paths_traced);
  return 0;
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  const bool keeps = argc > 2 && std::strcmp(argv[1], "--sensors") == 0;
  const int first = keeps ? 3 : 1;
  const long sensors = argc > first + 1 ? std::atol(argv[first]) : 0;
  if (sensors < 1) {
    std::fputs("bench_time_to_error: [--sensors FILE] SENSORS SCENE...\n", stderr);
    return 1;
  }
  int failed = 0;
  for (int i = first + 1; i < argc; ++i)
    failed |=
        halflight::compare(static_cast<std::size_t>(sensors), argv[i], keeps ? argv[2] : nullptr);
  return failed;
}
