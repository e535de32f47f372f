#include "experiments/figures7and8.h"

#include <chrono>
#include <functional>

#include <fmt/format.h>

#include "experiments/desk_office.h"
#include "experiments/figures.h"
#include "experiments/published_extinction.h"
#include "halflight/base/parallel.h"
#include "halflight/hierarchy/build_hierarchy.h"
#include "halflight/hierarchy/kd_tree.h"
#include "halflight/output/read_light.h"
#include "halflight/output/tone_map.h"
#include "halflight/rays/camera_rays.h"
#include "halflight/rays/world.h"
#include "halflight/solve/solver.h"
#include "halflight/visibility/multires_tree.h"

namespace halflight::experiments {
namespace {

constexpr int kLong = 6, kShort = 2;  // samples of each light
constexpr float kRadiance = 20.f;
constexpr float kWhite = 8.f;  // radiosity shown as white, W/m2
constexpr int kPictureWidth = 480, kPictureHeight = 320;
// Of the SIGGRAPH version, with its own hierarchy.
constexpr const char* kPaperSurfaceSeconds = "1216";
constexpr const char* kPaperAverageSeconds = "376";
constexpr float kCoarseError = 0.2f;

using Transmittance = std::function<float(const Vec3& receiver, const Vec3& emitter)>;

struct OfficeView {
  DeskOffice office;
  World world;
  Surfaces surfaces;

  OfficeView()
      : office(desk_office()), world(office.scene), surfaces(build_surfaces(world.geometry)) {}
};

float direct_irradiance(const OfficeView& view, const Vec3& x, const Vec3& n,
                        const Transmittance& transmittance) {
  const Vec3 from = view.world.rays.lift(x, n);
  float sum = 0.f;
  for (const CeilingLight& light : view.office.lights)
    for (int i = 0; i < kLong; ++i)
      for (int j = 0; j < kShort; ++j) {
        const float u = 2.f * (static_cast<float>(i) + 0.5f) / kLong - 1.f;
        const float v = 2.f * (static_cast<float>(j) + 0.5f) / kShort - 1.f;
        const Vec3 to = view.world.rays.lift(
            light.center + Vec3(u * light.half.x, 0.f, v * light.half.y), {0.f, -1.f, 0.f});
        const Vec3 d = to - from;
        const float cosines = glm::dot(d, n) * d.y;
        if (glm::dot(d, n) <= 0.f || d.y <= 0.f) continue;
        const float square = glm::dot(d, d);
        const float area = 4.f * light.half.x * light.half.y / (kLong * kShort);
        sum += kRadiance * area * cosines / (square * square) * transmittance(from, to);
      }
  return sum;
}

double mean_under_desks(const OfficeView& view, const Transmittance& transmittance) {
  double sum = 0.0;
  for (const Vec3& x : view.office.under_desks)
    sum += static_cast<double>(direct_irradiance(view, x, {0.f, 1.f, 0.f}, transmittance));
  return sum / static_cast<double>(view.office.under_desks.size());
}

// Shows each pixel's surface by `radiosity_at`.
Image picture_of(const OfficeView& view, int width, int height,
                 const std::function<Rgb(const RayHit&, const Vec3& position, const Vec3& normal)>&
                     radiosity_at) {
  Image image(width, height);
  const CameraRays camera(view.world.geometry.cameras.front(), width, height);
  parallel_for(static_cast<std::size_t>(height), 4, [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const CameraRay ray =
          camera.through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const auto hit = view.world.rays.closest_hit(ray.origin, ray.direction, kInfinity, 0);
      if (!hit) continue;
      const Rgb b = radiosity_at(*hit, hit_position(view.world.geometry, *hit),
                                 hit_normal(view.world.geometry, *hit));
      image.at(x, static_cast<int>(y)) = tone_mapped(ToneMap::none, b / kWhite);
    }
  });
  return image;
}

Image direct_picture(const OfficeView& view, int width, int height,
                     const Transmittance& transmittance) {
  const Scene& scene = view.world.scene;
  const Geometry& g = view.world.geometry;
  return picture_of(view, width, height, [&](const RayHit& hit, const Vec3& x, const Vec3& n) {
    if (scene.materials[g.materials[hit.triangle]].emits()) return Rgb(kWhite);
    // What indirect light there is, shown as the same everywhere.
    const float irradiance = direct_irradiance(view, x, n, transmittance) + 0.08f * kWhite;
    return irradiance * reflectance_at(scene, g, hit.triangle, hit.barycentric);
  });
}

// The rays of the picture's floor and desks, one core: what figure 8 times.
struct TimedRays {
  std::vector<VisibilityRay> rays;

  explicit TimedRays(const OfficeView& view) {
    const Bounds3f& room = view.world.geometry.bounds;
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j) {
        const Vec3 above(room.lower.x + room.extent().x * (static_cast<float>(i) + 0.5f) / 64.f,
                         1.6f,
                         room.lower.z + room.extent().z * (static_cast<float>(j) + 0.5f) / 64.f);
        const Vec3 down(0.f, -1.f, 0.f);
        const auto hit = view.world.rays.closest_hit(above, down, kInfinity, 0);
        if (!hit) continue;
        const auto collect = [&](const Vec3& from, const Vec3& to) {
          rays.push_back({from, to - from, 1.f});
          return 0.f;
        };
        direct_irradiance(view, hit_position(view.world.geometry, *hit), -down, collect);
      }
  }

  template <class Answer>
  double seconds(const Answer& answer) const {
    const auto start = std::chrono::steady_clock::now();
    float sum = 0.f;
    for (const VisibilityRay& ray : rays) sum += answer(ray, nullptr);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    return sum >= 0.f ? time.count() : 0.0;
  }
  template <class Answer>
  double nodes(const Answer& answer) const {
    TraversalCount count;
    for (const VisibilityRay& ray : rays) answer(ray, &count);
    return static_cast<double>(count.nodes) / static_cast<double>(rays.size());
  }
};

AverageOffice light_by(const OfficeView& view, const TimedRays& timed, const std::string& name,
                       const ClusterTree& clusters, double exact_under_desks, int width,
                       int height) {
  MultiresOptions options;
  options.receiver_clearance = 0.f;
  const MultiresTree tree(view.world.scene, view.world.geometry, view.surfaces, clusters, options);
  const PublishedExtinction published(view.world, view.surfaces, clusters);
  const auto average = [&](const VisibilityRay& ray, TraversalCount* count) {
    return tree.average(ray, StopRule::never(), count);
  };
  const auto exact = [&](const VisibilityRay& ray, TraversalCount* count) {
    return tree.multires(ray, StopRule::never(), count);
  };
  const Transmittance by_average = [&](const Vec3& from, const Vec3& to) {
    return average({from, to - from, 1.f}, nullptr);
  };
  const Transmittance by_published = [&](const Vec3& from, const Vec3& to) {
    return published.transmittance(from, to);
  };
  AverageOffice lit;
  lit.hierarchy = name;
  lit.clusters = clusters.clusters.size();
  lit.exact_seconds = timed.seconds(exact);
  lit.average_seconds = timed.seconds(average);
  lit.exact_nodes = timed.nodes(exact);
  lit.average_nodes = timed.nodes(average);
  lit.under_desks = mean_under_desks(view, by_average) / exact_under_desks;
  lit.under_desks_published = mean_under_desks(view, by_published) / exact_under_desks;
  if (width > 0) {
    lit.picture = direct_picture(view, width, height, by_average);
    lit.published_picture = direct_picture(view, width, height, by_published);
  }
  return lit;
}

std::vector<AverageOffice> light_office(const OfficeView& view, int width, int height) {
  const TimedRays timed(view);
  const Transmittance exact = [&](const Vec3& from, const Vec3& to) {
    return view.world.rays.transmittance(from, to);
  };
  const double under_desks = mean_under_desks(view, exact);
  AverageOffice reference;
  reference.hierarchy = "exact";
  reference.under_desks = reference.under_desks_published = 1.0;
  if (width > 0) reference.picture = direct_picture(view, width, height, exact);
  std::vector<AverageOffice> all{reference};
  AverageOffice unshadowed;
  unshadowed.hierarchy = "no shadows";
  unshadowed.under_desks = unshadowed.under_desks_published =
      mean_under_desks(view, [](const Vec3&, const Vec3&) { return 1.f; }) / under_desks;
  all.push_back(unshadowed);
  const auto add = [&](const std::string& name, const ClusterTree& tree) {
    all.push_back(light_by(view, timed, name, tree, under_desks, width, height));
  };
  for (const NamedHierarchy& h : kHierarchies)
    add(std::string(h.name), build_hierarchy(h.kind, view.surfaces));
  std::vector<Bounds3f> boxes;
  for (const Surface& s : view.surfaces.surfaces) boxes.push_back(s.box);
  KdTreeOptions whole_cells;
  whole_cells.whole_cells = true;
  add("kd-tree, whole cells", build_kd_tree(boxes, whole_cells));
  return all;
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

}  // namespace

std::vector<AverageOffice> light_office_by_extinction(int width, int height) {
  return light_office(OfficeView(), width, height);
}

Result<Section> run_figure7(const Progress& progress) {
  const OfficeView view;
  const auto world = make_world(view.office.scene);
  Section section{"figure7", "Figure 7: surface visibility with each hierarchy", {}, {}};
  PictureRow row{"Solved radiosity, surface by surface", {}};
  Table table{"Solving with exact visibility at a high tolerance",
              {"hierarchy", "time, s", "links", "rays", "paper's time, s"},
              {}};
  for (std::size_t i = 0; i < kHierarchies.size(); ++i) {
    progress.report("figure7", static_cast<double>(i) / kHierarchies.size());
    if (progress.cancelled()) return system_error("interrupted", "figure7");
    SolveOptions options;
    options.hierarchy = kHierarchies[i].kind;
    options.links = LinkMaker::refined;
    options.error = kCoarseError;
    options.levels = 2;
    const std::uint64_t rays_before = world->rays.ray_total();
    const auto start = std::chrono::steady_clock::now();
    SolverState state = make_state(world, options);
    while (!state.done()) advance(state, Progress());
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    const std::uint64_t rays = world->rays.ray_total() - rays_before;
    const std::string name(kHierarchies[i].name);
    const SolutionReader reader(state, {});
    row.pictures.push_back({"figure7-" + name,
                            picture_of(view, kPictureWidth, kPictureHeight,
                                       [&](const RayHit& hit, const Vec3&, const Vec3&) {
                                         return reader.reflected_radiosity(hit);
                                       }),
                            name});
    table.rows.push_back({name, fmt::format("{:.2f}", time.count()),
                          fmt::format("{}", state.link_total()), fmt::format("{}", rays),
                          i == 0 ? kPaperSurfaceSeconds : "-"});
    section.numbers.push_back({{"hierarchy", name},
                               {"seconds", time.count()},
                               {"links", state.link_total()},
                               {"rays", rays}});
  }
  section.blocks = {
      fmt::format("An office of {} polygons, each cluster's light exchanged as a whole and shadows "
                  "found surface by surface. At this tolerance the links differ with the "
                  "hierarchy, and so do the blocks that they leave.",
                  view.surfaces.surfaces.size()),
      row, table};
  return section;
}

Result<Section> run_figure8(const Progress& progress) {
  progress.report("figure8", 0.0);
  const OfficeView view;
  const auto offices = light_office(view, kPictureWidth, kPictureHeight);
  if (progress.cancelled()) return system_error("interrupted", "figure8");
  Section section{"figure8", "Figure 8: average visibility with each hierarchy", {}, {}};
  PictureRow ours{"Clusters that hold an end of the ray are opened", {}};
  PictureRow published{"As published: surfaces fill the clusters they are attached to", {}};
  Table table{"Direct light by extinction alone",
              {"hierarchy", "clusters", "exact, s", "average, s", "exact, nodes a ray",
               "average, nodes a ray", "under the desks", "as published", "paper's time, s"},
              {}};
  for (const AverageOffice& o : offices) {
    std::string file = "figure8-" + o.hierarchy.substr(0, o.hierarchy.find(','));
    if (o.hierarchy.find(',') != std::string::npos) file += "-cells";
    if (o.picture.width > 0) ours.pictures.push_back({file, o.picture, o.hierarchy});
    if (o.hierarchy == "exact") continue;
    if (o.published_picture.width > 0)
      published.pictures.push_back({file + "-published", o.published_picture, o.hierarchy});
    table.rows.push_back(
        {o.hierarchy, fmt::format("{}", o.clusters), fmt::format("{:.3f}", o.exact_seconds),
         fmt::format("{:.3f}", o.average_seconds), fmt::format("{:.1f}", o.exact_nodes),
         fmt::format("{:.1f}", o.average_nodes), percent(o.under_desks),
         percent(o.under_desks_published),
         o.hierarchy == "size-grid" ? kPaperAverageSeconds : "-"});
    section.numbers.push_back({{"hierarchy", o.hierarchy},
                               {"clusters", o.clusters},
                               {"exact_seconds", o.exact_seconds},
                               {"average_seconds", o.average_seconds},
                               {"exact_nodes_per_ray", o.exact_nodes},
                               {"average_nodes_per_ray", o.average_nodes},
                               {"under_desks", o.under_desks},
                               {"under_desks_published", o.under_desks_published}});
  }
  section.blocks = {
      fmt::format("The same office of {} polygons by extinction alone, down to the last clusters. "
                  "Light under the desks is a share of the exact: 100 % keeps the shadow, more "
                  "loses it.",
                  view.surfaces.surfaces.size()),
      ours, published, table};
  return section;
}

}  // namespace halflight::experiments
