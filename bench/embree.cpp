// Exact shadow rays against bare Embree on the same segments: what our layer around it costs.
//
//   bench_embree                       the built-in scenes
//   bench_embree SCENE...              files
//
// Segments: from places all over the surfaces to places on emitters, as for direct light ("shadow",
// receivers ordered as the elements of a solve are, neighbours beside each other), and between
// places on any two surfaces ("between", in no order). Bare: rtcOccluded1 in a loop, no filter, on
// the same triangles; once as we ask for it (AVX2, robust, part of the promise of equal bytes), and
// once with Embree's own defaults. Only scenes that let no light through compare, and others are
// refused. All ways take turns, and the fastest turn of each counts. Lines of JSON: rays for each
// second of processor time and their ratios, which others on the machine disturb least; the gain of
// a second thread in wall time; by how many segments the numbers of blocked ones differ.
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>

#include "halflight/base/hash.h"
#include "halflight/base/morton.h"
#include "halflight/base/parallel.h"
#include "halflight/io/load_scene.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/cornell_box.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"
#include "halflight/visibility/visibility.h"

namespace halflight {
namespace {

constexpr std::size_t kSegments = 1u << 19;
constexpr std::size_t kGrain = 1024;
constexpr int kTurns = 7;
constexpr std::array kThreads{1, 2};

// The same triangles, nothing else.
class BareEmbree {
 public:
  BareEmbree(const Geometry& g, const char* config, RTCSceneFlags flags)
      : device_(rtcNewDevice(config)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, flags);
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               g.positions.raw().data(), 0, sizeof(Vec3), g.positions.size());
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), g.triangles.size()));
    for (const auto& corners : g.triangles)
      for (const VertexId v : corners) *indices++ = v.value;
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
  }
  ~BareEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;

  bool blocked(RTCIntersectContext& context, const RayEnds& s) const {
    const Vec3 d = s.emitter - s.receiver;
    RTCRay ray{};
    ray.org_x = s.receiver.x;
    ray.org_y = s.receiver.y;
    ray.org_z = s.receiver.z;
    ray.dir_x = d.x;
    ray.dir_y = d.y;
    ray.dir_z = d.z;
    ray.tfar = 1.f;
    ray.mask = ~0u;
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0.f;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

struct Place {
  Vec3 position, normal;
};

// Uniform over the area of some triangles, lifted off them on a side chosen by chance.
class Places {
 public:
  Places(const World& world, std::vector<TriangleId> triangles)
      : world_(world), triangles_(std::move(triangles)) {
    for (const TriangleId t : triangles_)
      area_before_.push_back(area_before_.back() + static_cast<double>(world.geometry.area(t)));
  }
  Place operator()(std::uint64_t i) const {
    const double at = static_cast<double>(to_unit_float(hash(i, 1))) * area_before_.back();
    const auto found = std::upper_bound(area_before_.begin(), area_before_.end(), at);
    const auto k = static_cast<std::size_t>(found - area_before_.begin() - 1);
    const TriangleId t = triangles_[std::min(k, triangles_.size() - 1)];
    const Vec3 n = glm::normalize(world_.geometry.scaled_normal(t)) *
                   (to_unit_float(hash(i, 2)) < 0.5f ? 1.f : -1.f);
    const Vec3 p = world_.geometry.point(t, uniform_triangle(random_shift(hash(i, 3))));
    return {world_.rays.lift(p, n), n};
  }

 private:
  const World& world_;
  std::vector<TriangleId> triangles_;
  std::vector<double> area_before_{0.0};
};

// Segments that leave both places on the side they were lifted to.
std::vector<RayEnds> segments_between(const Places& receivers, const Places& emitters) {
  std::vector<RayEnds> segments;
  for (std::uint64_t i = 0; segments.size() < kSegments && i < 64 * kSegments; ++i) {
    const Place r = receivers(hash(i, 11)), e = emitters(hash(i, 12));
    const Vec3 d = e.position - r.position;
    if (glm::dot(d, r.normal) > 0.f && glm::dot(d, e.normal) < 0.f)
      segments.push_back({r.position, e.position});
  }
  return segments;
}

struct Way {
  const char* name;
  std::function<std::size_t(std::size_t first, std::size_t last)> blocked;  // of these segments
  std::size_t total = 0;
  double cpu_seconds = 1e30, wall_seconds = 1e30;  // of the fastest turn
};

void turn(Way& way, std::size_t segments, int threads) {
  const std::size_t blocks = (segments + kGrain - 1) / kGrain;
  const auto block = [&](std::size_t b) {
    return way.blocked(b * kGrain, std::min(segments, (b + 1) * kGrain));
  };
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  std::size_t total = 0;
  if (threads == 1)
    for (std::size_t b = 0; b < blocks; ++b) total += block(b);
  else
    total = parallel_sum(blocks, 8, std::size_t{0}, block);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const double cpu = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  way.wall_seconds = std::min(way.wall_seconds, wall.count());
  way.cpu_seconds = std::min(way.cpu_seconds, cpu);
  way.total = total;
}

void compare(const std::string& scene, const World& world, const char* kind,
             const std::vector<RayEnds>& segments) {
  const Visibility visibility(world);
  const BareEmbree same(world.geometry, "isa=avx2", RTC_SCENE_FLAG_ROBUST),
      defaults(world.geometry, nullptr, RTC_SCENE_FLAG_NONE);
  const auto bare = [&](const BareEmbree& embree) {
    return [&](std::size_t first, std::size_t last) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      std::size_t count = 0;
      for (std::size_t i = first; i < last; ++i) count += embree.blocked(context, segments[i]);
      return count;
    };
  };
  double one_thread = 0.0;  // wall seconds
  for (const int threads : kThreads) {
    set_thread_count(threads);
    std::array ways{Way{"halflight",
                        [&](std::size_t first, std::size_t last) {
                          std::size_t count = 0;
                          for (std::size_t i = first; i < last; ++i)
                            count += visibility.transmittance(segments[i]) == 0.f;
                          return count;
                        }},
                    Way{"bare", bare(same)}, Way{"bare_defaults", bare(defaults)}};
    for (int t = 0; t < kTurns; ++t)
      for (Way& w : ways) turn(w, segments.size(), threads);
    const auto rate = [&](const Way& w) {
      return static_cast<double>(segments.size()) / w.cpu_seconds;
    };
    if (threads == 1) one_thread = ways[0].wall_seconds;
    fmt::print(
        R"({{"scene": "{}", "triangles": {}, "segments": "{}", "count": {}, "blocked": {:.3f}, )"
        R"("threads": {}, "halflight": {:.4g}, "bare": {:.4g}, "bare_defaults": {:.4g}, )"
        R"("ratio": {:.3f}, "ratio_to_defaults": {:.3f}, "speedup": {:.2f}, "differ": {}}})"
        "\n",
        scene, world.geometry.triangles.size(), kind, segments.size(),
        static_cast<double>(ways[0].total) / static_cast<double>(segments.size()), threads,
        rate(ways[0]), rate(ways[1]), rate(ways[2]), rate(ways[0]) / rate(ways[1]),
        rate(ways[0]) / rate(ways[2]), one_thread / ways[0].wall_seconds,
        ways[0].total > ways[1].total ? ways[0].total - ways[1].total
                                      : ways[1].total - ways[0].total);
    std::fflush(stdout);
  }
}

bool compare(const std::string& name, Scene scene) {
  const auto world = make_world(std::move(scene));
  const Geometry& g = world->geometry;
  std::vector<TriangleId> all, shining;
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    const Material& m = world->scene.materials[g.materials[t]];
    if (may_be_transparent(m)) {
      fmt::print(stderr, "{}: lets light through, which bare Embree does not; left out\n", name);
      return false;
    }
    all.push_back(t);
    if (m.emits()) shining.push_back(t);
  }
  if (shining.empty()) {
    fmt::print(stderr, "{}: no surface of it shines; left out\n", name);
    return false;
  }
  const Places receivers(*world, all), emitters(*world, shining);
  auto shadow = segments_between(receivers, emitters);
  std::sort(shadow.begin(), shadow.end(), [&](const RayEnds& a, const RayEnds& b) {
    return morton_code(a.receiver, g.bounds) < morton_code(b.receiver, g.bounds);
  });
  compare(name, *world, "shadow", shadow);
  compare(name, *world, "between", segments_between(receivers, receivers));
  return true;
}

}  // namespace
}  // namespace halflight

int main(int argc, char** argv) {
  using namespace halflight;
  // As RayScene sets it, and as Embree recommends.
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  int status = 0;
  for (int i = 1; i < argc; ++i) {
    auto scene = load_scene(argv[i], {});
    if (!scene) fmt::print(stderr, "{}\n", scene.error().line());
    if (!scene || !compare(argv[i], std::move(*scene))) status = 1;
  }
  if (argc > 1) return status;
  compare("cornell-box", cornell_box_scene());
  compare("loose-triangles", loose_triangles_scene());
  compare("plants", plants_scene({1 << 16, 1}));
  compare("plants", plants_scene({1 << 20, 1}));
  compare("office", office_scene());
  return 0;
}
