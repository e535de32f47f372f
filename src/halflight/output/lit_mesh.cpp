#include "halflight/output/lit_mesh.h"

#include <tsl/robin_map.h>

#include "halflight/base/parallel.h"
#include "halflight/output/refine_mesh.h"

namespace halflight {
namespace {

// Area-weighted mean over the shown sides.
Rgb mean_irradiance(const WorkMesh& mesh, const Geometry& g) {
  struct Sum {
    glm::dvec3 light{0.0};
    double area = 0.0;
    Sum& operator+=(const Sum& s) {
      light += s.light;
      area += s.area;
      return *this;
    }
  };
  const Sum sum = parallel_sum<Sum>(mesh.sheets.size(), 4096, {}, [&](std::size_t i) {
    const Sheet& s = mesh.sheets[SheetId(i)];
    const double area = g.area(s.source);
    glm::dvec3 light(0.0);
    for (const LitVertexId v : s.corners)
      light += glm::dvec3(mesh.sites[mesh.site(v)].light.irradiance()) / 3.0;
    return Sum{area * light, area};
  });
  return sum.area > 0.0 ? Rgb(sum.light / sum.area) : Rgb(0.f);
}

// Surfaces run on into other solids: a wall goes up behind the ceiling. With reflected light about,
// a place that no light reaches at all is buried like that, and its blackness would bleed over the
// triangles that come out of the solid. It takes the mean light of its lit neighbours instead.
void fill_buried_sites(WorkMesh& mesh) {
  const auto is_black = [](const Reading& r) { return r.irradiance() == Rgb(0.f); };
  const bool has_reflections = std::any_of(mesh.sites.begin(), mesh.sites.end(), [](const Site& s) {
    return s.light.indirect != Rgb(0.f);
  });
  if (!has_reflections) return;
  struct Neighbours {
    Reading sum;
    float count = 0.f;
  };
  tsl::robin_map<std::uint32_t, Neighbours> buried;
  for (const Sheet& s : mesh.sheets)
    for (const LitVertexId v : s.corners) {
      if (!is_black(mesh.sites[mesh.site(v)].light)) continue;
      Neighbours& n = buried[mesh.site(v).value];
      for (const LitVertexId w : s.corners) {
        const Reading& light = mesh.sites[mesh.site(w)].light;
        if (is_black(light)) continue;
        n.sum.direct += light.direct;
        n.sum.indirect += light.indirect;
        n.count += 1.f;
      }
    }
  for (const auto& [site, n] : buried)
    if (n.count > 0.f)
      mesh.sites[SiteId(site)].light = {n.sum.direct / n.count, n.sum.indirect / n.count};
}

// Of the primitive that shows a sheet: by instance, fronts before backs.
std::uint64_t rank(const Sheet& s, const Geometry& g) {
  return 2 * std::uint64_t{g.instances[s.source].value} + (s.back ? 1 : 0);
}

// Sheets by primitive, then by input triangle.
std::vector<SheetId> in_output_order(const WorkMesh& mesh, const Geometry& g) {
  std::vector<std::pair<std::uint64_t, SheetId>> ranked;
  ranked.reserve(mesh.sheets.size());
  for (std::size_t i = 0; i < mesh.sheets.size(); ++i) {
    const Sheet& s = mesh.sheets[SheetId(i)];
    ranked.emplace_back(rank(s, g) << 32 | s.source.value, i);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<SheetId> order;
  order.reserve(ranked.size());
  for (const auto& [rank, sheet] : ranked) order.push_back(sheet);
  return order;
}

// Copies vertices into a primitive, each once.
class PrimitiveFiller {
 public:
  explicit PrimitiveFiller(const WorkMesh& mesh)
      : mesh_(mesh), owner_(mesh.vertices.size(), kNone), index_(mesh.vertices.size()) {}

  void start(LitPrimitive& p, std::uint32_t id, std::array<bool, 2> has_uvs) {
    primitive_ = &p;
    id_ = id;
    has_uvs_ = has_uvs;
  }
  std::uint32_t index_of(LitVertexId v) {
    if (owner_[v] == id_) return index_[v];
    owner_[v] = id_;
    index_[v] = static_cast<std::uint32_t>(primitive_->positions.size());
    const LitVertex& vertex = mesh_.vertices[v];
    const Site& site = mesh_.sites[vertex.site];
    primitive_->positions.push_back(mesh_.points[site.point]);
    primitive_->normals.push_back(site.normal);
    for (std::size_t set = 0; set < 2; ++set)
      if (has_uvs_[set]) primitive_->uvs[set].push_back(vertex.uvs[set]);
    primitive_->irradiance.push_back(site.light.irradiance());
    primitive_->indirect.push_back(site.light.indirect);
    return index_[v];
  }

 private:
  static constexpr std::uint32_t kNone = ~0u;
  const WorkMesh& mesh_;
  LitPrimitive* primitive_ = nullptr;
  std::uint32_t id_ = 0;
  std::array<bool, 2> has_uvs_{};
  IdVector<LitVertexId, std::uint32_t> owner_, index_;
};

// Adds the primitives, and the simpler triangles of each.
void add_primitives(LitMesh& result, const WorkMesh& mesh, std::vector<Sheet> simple,
                    const Scene& scene, const Geometry& g) {
  std::vector<LitPrimitive>& primitives = result.primitives;
  PrimitiveFiller filler(mesh);
  const auto less = [&g](const Sheet& a, const Sheet& b) { return rank(a, g) < rank(b, g); };
  std::stable_sort(simple.begin(), simple.end(), less);
  const auto corners = [&filler](const Sheet& s) {
    return std::array{filler.index_of(s.corners[0]), filler.index_of(s.corners[1]),
                      filler.index_of(s.corners[2])};
  };
  for (const SheetId id : in_output_order(mesh, g)) {
    const Sheet& s = mesh.sheets[id];
    const InstanceId instance = g.instances[s.source];
    if (primitives.empty() || primitives.back().instance != instance ||
        primitives.back().back != s.back) {
      LitPrimitive& added = primitives.emplace_back();
      added.instance = instance;
      added.back = s.back;
      const PrimitiveInstance& what = g.primitive_instances[instance];
      const Primitive& source = scene.meshes[what.mesh].primitives[what.primitive];
      filler.start(added, static_cast<std::uint32_t>(primitives.size()),
                   {!source.uvs[0].empty(), !source.uvs[1].empty()});
      if (!simple.empty()) {
        auto& kept = result.simple.emplace_back();
        const auto [first, last] = std::equal_range(simple.begin(), simple.end(), s, less);
        for (auto it = first; it != last; ++it) kept.push_back(corners(*it));
      }
    }
    LitPrimitive& p = primitives.back();
    p.triangles.push_back(corners(s));
    p.sources.push_back(s.source);
  }
}

LitMesh build_shown(const Scene& scene, const Geometry& g, WeldedPoints points,
                    const SharedEdges& edges, const IdVector<TriangleId, ShownSides>& shown,
                    const LightReader& read, LitMeshOptions options, const Progress& progress) {
  if (options.coarse <= 0.f) options.coarse = 4.f * options.feature_size;
  if (options.finest <= 0.f) options.finest = options.feature_size / 2.f;
  LitMesh result;
  WorkMesh mesh = make_work_mesh(g, std::move(points), edges, shown, options.feature_size,
                                 [&](std::span<const ReadingPoint> places) {
                                   result.readings += places.size();
                                   return read(places);
                                 });
  result.mean_irradiance = mean_irradiance(mesh, g);
  std::vector<Sheet> simple = refine_mesh(mesh, shown, read, options,
                                          max_component(result.mean_irradiance), progress, result);
  fill_buried_sites(mesh);
  add_primitives(result, mesh, std::move(simple), scene, g);
  for (const LitPrimitive& p : result.primitives) {
    result.vertices += p.positions.size();
    result.triangles += p.triangles.size();
  }
  return result;
}

}  // namespace

LitMesh build_lit_mesh(const Scene& scene, const Geometry& g, const LightReader& read,
                       const LitMeshOptions& options, const Progress& progress) {
  std::size_t readings = 0;
  WeldedPoints points = weld(g);
  const SharedEdges edges(g, points);
  const auto shown = choose_shown_sides(scene, g, edges, options.feature_size,
                                        [&](std::span<const ReadingPoint> places) {
                                          readings += places.size();
                                          return read(places);
                                        });
  LitMesh mesh = build_shown(scene, g, std::move(points), edges, shown, read, options, progress);
  mesh.readings += readings;
  return mesh;
}

LitMesh build_lit_mesh(const Scene& scene, const Geometry& g,
                       const IdVector<TriangleId, ShownSides>& shown, const LightReader& read,
                       const LitMeshOptions& options, const Progress& progress) {
  WeldedPoints points = weld(g);
  const SharedEdges edges(g, points);
  return build_shown(scene, g, std::move(points), edges, shown, read, options, progress);
}

}  // namespace halflight
