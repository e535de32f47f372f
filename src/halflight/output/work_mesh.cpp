#include "halflight/output/work_mesh.h"

#include "halflight/base/parallel.h"
#include "halflight/output/disjoint_sets.h"
#include "halflight/output/smooth_sides.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 4096;

struct Corners {
  std::vector<FaceCorner> all;                // corner k of sheet i at 3 i + k
  IdVector<TriangleId, SheetId> front, back;  // invalid where a side is not shown
};

void add_sheets(const Geometry& g, const IdVector<TriangleId, ShownSides>& shown, WorkMesh& mesh,
                Corners& corners) {
  corners.front.resize(g.triangles.size());
  corners.back.resize(g.triangles.size());
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    if (shown[t].front) corners.front[t] = mesh.sheets.push_back({{}, t, false});
    if (shown[t].back) corners.back[t] = mesh.sheets.push_back({{}, t, true});
  }
}

// Joins the corners at both ends of every edge across which a shown surface continues.
void join_corners(const SharedEdges& edges, const IdVector<TriangleId, ShownSides>& shown,
                  const Corners& corners, DisjointSets& sets,
                  std::vector<std::array<bool, 3>>& continues_at) {
  const auto sheet_of = [&](TriangleFace f) {
    return (f.back ? corners.back : corners.front)[f.triangle].value;
  };
  for_each_joint(edges, shown,
                 [&](TriangleFace a, std::uint32_t a_side, TriangleFace b, std::uint32_t b_side) {
                   const std::uint32_t s = sheet_of(a), r = sheet_of(b);
                   const std::uint32_t s_start = 3 * s + a_side, s_end = 3 * s + (a_side + 1) % 3;
                   const std::uint32_t r_start = 3 * r + b_side, r_end = 3 * r + (b_side + 1) % 3;
                   if (!continues(corners.all[s_start], corners.all[r_end]) ||
                       !continues(corners.all[s_end], corners.all[r_start]))
                     return;
                   sets.join(s_start, r_end);
                   sets.join(s_end, r_start);
                   continues_at[s][a_side] = continues_at[r][b_side] = true;
                 });
}

// What the corners of a site add up to.
struct SiteShape {
  Vec3 inwards{0.f};  // mean direction into the surface, weighted by angle
  bool on_border = false;
  std::uint32_t reading_corner = 0;  // the corner that holds the reading point
  float reading_fit = -kInfinity;
};

// A reading exactly on a crease is ill-defined: half of its rays may start inside the other wall.
// So sites on the border of their surface are read a little inside of it.
ReadingPoint reading_point(const Geometry& g, const WorkMesh& mesh, const Corners& corners,
                           const SiteShape& shape, const Site& site, float feature_size) {
  const Sheet& sheet = mesh.sheets[SheetId(shape.reading_corner / 3)];
  ReadingPoint point{mesh.points[site.point], site.normal, sheet.source};
  if (!shape.on_border) return point;
  const auto p = g.corners(sheet.source);
  const std::size_t at = source_corner(sheet.back, shape.reading_corner % 3);
  const Vec3 face = glm::normalize(g.scaled_normal(sheet.source));
  const Vec3 e1 = p[(at + 1) % 3] - p[at], e2 = p[(at + 2) % 3] - p[at];
  const float reach =
      std::min(feature_size / 8.f, std::min(glm::length(e1), glm::length(e2)) / 4.f);
  const Vec3 along = shape.inwards - glm::dot(shape.inwards, face) * face;
  const float length = glm::length(along);
  if (length > 0.f) {
    const Vec3 pulled = along * (reach / length);
    // Barycentric coordinates of the pulled point about this corner.
    const float doubled_area = glm::dot(glm::cross(e1, e2), face);
    const float b1 = glm::dot(glm::cross(pulled, e2), face) / doubled_area;
    const float b2 = glm::dot(glm::cross(e1, pulled), face) / doubled_area;
    if (b1 >= 0.f && b2 >= 0.f && b1 + b2 < 0.5f) {
      point.position += pulled;
      return point;
    }
  }
  const float to_centroid = glm::length(e1 + e2) / 3.f;
  point.position += corners.all[shape.reading_corner].inwards * std::min(reach, to_centroid / 2.f);
  return point;
}

}  // namespace

LitVertexId WorkMesh::find_or_add_vertex(SiteId site_id, InstanceId instance, bool back,
                                         const std::array<Vec2, 2>& uvs) {
  Site& site = sites[site_id];
  for (LitVertexId v = site.first_vertex; v.valid(); v = vertices[v].next)
    if (vertices[v].instance == instance && vertices[v].back == back && vertices[v].uvs == uvs)
      return v;
  site.first_vertex = vertices.push_back({site_id, instance, back, uvs, site.first_vertex});
  return site.first_vertex;
}

WorkMesh make_work_mesh(const Geometry& g, WeldedPoints points, const SharedEdges& edges,
                        const IdVector<TriangleId, ShownSides>& shown, float feature_size,
                        const LightReader& read) {
  WorkMesh mesh;
  Corners corners;
  add_sheets(g, shown, mesh, corners);
  corners.all.resize(3 * mesh.sheets.size());
  parallel_for(corners.all.size(), kGrain, [&](std::size_t i) {
    const Sheet& sheet = mesh.sheets[SheetId(i / 3)];
    corners.all[i] = measure_corner(g, {sheet.source, sheet.back}, i % 3);
  });
  DisjointSets sets(corners.all.size());
  std::vector<std::array<bool, 3>> continues_at(mesh.sheets.size(), {false, false, false});
  join_corners(edges, shown, corners, sets, continues_at);

  mesh.points = std::move(points.positions);
  std::vector<SiteId> site_of(corners.all.size());
  std::vector<SiteShape> shapes;
  for (std::uint32_t i = 0; i < corners.all.size(); ++i) {
    Sheet& sheet = mesh.sheets[SheetId(i / 3)];
    const VertexId v = g.triangles[sheet.source][source_corner(sheet.back, i % 3)];
    const std::uint32_t root = sets.root(i);
    if (root == i) {
      site_of[i] = mesh.sites.push_back({points.of_vertex[v], Vec3(0.f), {}, {}});
      shapes.push_back({});
    }
    const SiteId site = site_of[i] = site_of[root];
    const FaceCorner& c = corners.all[i];
    mesh.sites[site].normal += c.angle * c.normal;
    SiteShape& shape = shapes[site.value];
    shape.inwards += c.angle * c.inwards;
    shape.on_border |= !continues_at[i / 3][i % 3] || !continues_at[i / 3][(i + 2) % 3];
    sheet.corners[i % 3] = mesh.find_or_add_vertex(site, g.instances[sheet.source], sheet.back,
                                                   {g.uv(0, v), g.uv(1, v)});
  }
  for (std::uint32_t i = 0; i < corners.all.size(); ++i) {
    SiteShape& shape = shapes[site_of[i].value];
    const FaceCorner& c = corners.all[i];
    const float fit = glm::dot(c.inwards, shape.inwards);
    if (fit > shape.reading_fit) shape.reading_fit = fit, shape.reading_corner = i;
  }
  std::vector<ReadingPoint> places(mesh.sites.size());
  parallel_for(places.size(), kGrain, [&](std::size_t i) {
    Site& site = mesh.sites[SiteId(i)];
    const float length = glm::length(site.normal);
    site.normal =
        length > 1e-3f ? site.normal / length : corners.all[shapes[i].reading_corner].normal;
    places[i] = reading_point(g, mesh, corners, shapes[i], site, feature_size);
  });
  const std::vector<Reading> light = read(places);
  for (std::size_t i = 0; i < light.size(); ++i) mesh.sites[SiteId(i)].light = light[i];
  return mesh;
}

}  // namespace halflight
